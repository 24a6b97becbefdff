"""Run trackers on the sequences of data sets, repeated with other random numbers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, Final, TypeVar, get_type_hints

import numpy as np

from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.scores.suite_table import Content, add_up
from peopleboy.studies.reproductions.experiment import Jackknife, Line, Samples, Values, mean
from peopleboy.studies.reproductions.experiments import sequence_scores as scores
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.statistics import PAPER, THESIS
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting, changes_of
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.tracker.evaluation.sequence import Sums

METRICS: Final = {"thesis": THESIS, "paper": PAPER}
RULES: Final = {
    "usual": (scores.USUAL,),
    "all": (scores.USUAL, scores.STRICT, scores.OWN_RANGE, scores.HALF),
    "causes": (
        *(scores.USUAL, scores.STRICT, scores.NEAR, scores.FAR, scores.RANGE),
        *(scores.HALF, scores.FOUND),
    ),
}
"""Counting rules, by the name of their group in declarations."""
BOXES, PEOPLE = "boxes aside [%]", "people aside [%]"
_ASIDE: Final = {BOXES: "candidates", PEOPLE: "targets"}
"""Columns with the share of strictly counted boxes or people that a counting rule ignores."""
RATE_HZ: Final = 15

CONTENTS: Final = {
    "frames_with_persons": "frames with persons",
    "frames": "frames",
    "tracks": "tracks",
    "detections": "detections",
    "occlusions": "occlusions",
    "at_once": "persons at once",
}
"""Columns of the thesis's table 3.1."""

Work = Callable[[SuiteRun, Path, TrackerSetting, int, float], Result]
"""Measures a tracker on a sequence, with a repeat's random stream and the noise of labels [px]."""
Row = Callable[[Sequence[Result], str], Sequence[float]]
"""Computes the columns from results of sequences, by a counting rule."""
Record = TypeVar("Record", bound=Sums)


@dataclass(frozen=True, slots=True)
class TrackerTrial:
    """A line of the table: a tracker on some data sets.

    Attributes:
        line: group and name.
        setting: the tracker.
        suites: names of the data sets, which are combined.
        rule: the counting rule.
    """

    line: Line
    setting: TrackerSetting
    suites: tuple[str, ...]
    rule: str


def trials(
    *,
    is_quick: bool,
    groups: Mapping[str, Any],
    trackers: Mapping[str, Any] | None = None,
    suites: Sequence[str] = (),
    sweep: Sequence[str] | Mapping[str, float] = (),
    rules: str = "usual",
    quick: Sequence[str] | None = None,
    quick_changes: Mapping[str, Any] | None = None,
) -> Iterator[TrackerTrial]:
    """Yield the lines of a declaration, group by group, tracker by tracker, rule by rule.

    Args:
        is_quick: whether this is a quick run.
        groups: a value of `sweep`, or overrides of the group: `suites`, `trackers`, `changes`.
        trackers: base by name, or `base` and `suites`.
        suites: names of the data sets, unless a group or tracker has its own.
        sweep: settings that get the group's value, or their offsets from it.
        rules: one of `RULES`; all but the usual counting rule are appended to a tracker's name.
        quick: groups of a quick run; all if omitted.
        quick_changes: further changes of the trackers in a quick run.
    """
    offsets = sweep if isinstance(sweep, Mapping) else dict.fromkeys(sweep, 0)
    for group, declared in groups.items():
        if is_quick and quick is not None and group not in quick:
            continue
        own = declared if isinstance(declared, Mapping) else {}
        values = own.get("changes") or (
            {} if own else {path: declared + more for path, more in offsets.items()}
        )
        changes = changes_of(values) + (changes_of(quick_changes or {}) if is_quick else ())
        for name, base in (own.get("trackers") or trackers or {}).items():
            tracker = base if isinstance(base, Mapping) else {"base": base}
            seen = tuple(tracker.get("suites") or own.get("suites") or suites)
            for rule in RULES[rules]:
                line = Line(group, name if rule == scores.USUAL else f"{name}, {rule}")
                yield TrackerTrial(line, TrackerSetting(tracker["base"], changes), seen, rule)


def contents(using: Measurement) -> Samples:
    """Count frames, tracks, detections and occlusions, data set by data set (thesis, table 3.1)."""
    plan = using.plan
    units = {name: [count_unit(run, plan.cache) for run in plan.runs([name])] for name in plan.suites}
    counted = using.grouped(units)
    totals = {name: asdict(add_up(Content(**one) for one in runs)) for name, runs in counted.items()}
    return {
        Line(name, "simulated"): {shown: np.array([float(total[key])]) for key, shown in CONTENTS.items()}
        for name, total in totals.items()
    }


def tracking(using: Measurement, *, metrics: str | Sequence[str], **declared: Any) -> Samples:
    """Score trackers by the thesis's or the paper's metrics [%].

    Args:
        using: the plan and stored results.
        metrics: "thesis", "paper", or names, including those of shares that a counting rule ignores.
        declared: arguments of `trials`.
    """
    names = METRICS[metrics] if isinstance(metrics, str) else tuple(metrics)

    def row(results: Sequence[Result], rule: str) -> list[float]:
        sums = add_sums([one[rule] for one in results])
        return [
            _aside(results, rule, _ASIDE[name]) if name in _ASIDE else metric(sums, name) for name in names
        ]

    return _measured(using, declared, scores.score_sequence, names, row)


def _aside(results: Sequence[Result], rule: str, kind: str) -> float:
    """Return the share of strictly counted boxes or people that is ignored [%]."""
    counted, every = (sum(one[way]["counts"][kind] for one in results) for way in (rule, scores.STRICT))
    return float(100 * (1 - counted / max(every, 1)))


def delay(using: Measurement, **declared: Any) -> Samples:
    """Measure how many frames trackers need after their start to find a clearly visible person."""

    def row(results: Sequence[Result], _: str) -> list[float]:
        needed = [frames for result in results for frames in result["needed"]]
        starts = sum(result["starts"] for result in results)
        frames = mean(needed)
        return [frames, frames / RATE_HZ, 100 * len(needed) / max(starts, 1)]

    return _measured(using, declared, scores.measure_delay, ("frames", "s", "found in 2 s [%]"), row)


def _measured(
    using: Measurement, declared: Mapping[str, Any], work: Work, names: Sequence[str], row: Row
) -> Samples:
    """Render the sequences, run all trackers on them, and combine the sequences of each repeat."""
    plan = using.plan
    lines = list(trials(is_quick=plan.is_quick, **declared))
    using.results(count_unit(run, plan.cache) for trial in lines for run in plan.runs(trial.suites))
    repeats = range(plan.repeats)
    found = using.grouped(
        {(k, trial): sequence_units(trial, plan, k, work) for k in repeats for trial in lines}
    )
    return {trial.line: _values([found[k, trial] for k in repeats], trial, names, row) for trial in lines}


def _values(
    repeats: Sequence[Sequence[Result]], trial: TrackerTrial, names: Sequence[str], row: Row
) -> dict[str, Values]:
    """Return each column's value per repeat; for a single repeat, with leave-one-out values."""
    first, *others = repeats
    if others or len(first) == 1:
        return dict(zip(names, np.array([row(one, trial.rule) for one in repeats]).T, strict=True))
    without = np.array([row([*first[:k], *first[k + 1 :]], trial.rule) for k in range(len(first))])
    return {
        name: Jackknife(float(whole), rest, trial.suites)
        for name, whole, rest in zip(names, row(first, trial.rule), without.T, strict=True)
    }


def count_unit(run: SuiteRun, cache: Path) -> Unit:
    """Return the unit that renders a run and counts its content."""
    return Unit(f"film {_run_key(run)}", scores.count_sequence, (run, cache))


def sequence_units(
    trial: TrackerTrial, plan: Plan, repeat: int, work: Work = scores.score_sequence
) -> list[Unit]:
    """Return a repeat's units of a trial: a tracker on each sequence, with one random stream."""
    return [
        sequence_unit(run, plan.cache, trial.setting, repeat, work, label_noise_px=plan.label_noise_px)
        for run in plan.runs(trial.suites)
    ]


def sequence_unit(
    run: SuiteRun,
    cache: Path,
    setting: TrackerSetting,
    repeat: int,
    work: Work = scores.score_sequence,
    *,
    label_noise_px: float = 0.0,
) -> Unit:
    """Return the unit that runs a tracker on one sequence."""
    labels = f" | labels {label_noise_px:g} px" if label_noise_px else ""
    key = f"{work.__name__} {_run_key(run)} | {setting.key} | {repeat}{labels}"
    return Unit(key, work, (run, cache, setting, repeat, label_noise_px))


def _run_key(run: SuiteRun) -> str:
    """Return the name of a run with its length, which is shorter in a quick run."""
    return f"{run.name} {run.scenario.duration_s:g}s"


def add_sums(results: Sequence[Result]) -> dict[str, Any]:
    """Add the sequences' sums of numerators and denominators, record by record."""
    totals: dict[str, Any] = {}
    for name, kind in scores.RECORDS.items():
        if name in results[0]:
            first, *others = [restored(kind, result[name]) for result in results]
            totals[name] = sum(others, start=first)
    return totals


def metric(sums: Mapping[str, Any], name: str) -> float:
    """Return a metric [%] from the sums."""
    return float(getattr(sums["thesis" if name in THESIS else "paper"], name.lower()))


def restored(kind: type[Record], data: Mapping[str, Any]) -> Record:
    """Restore a record of sums from the plain data of `asdict`."""
    hints = get_type_hints(kind)
    nested = {
        field.name: restored(hints[field.name], data[field.name])
        for field in fields(kind)
        if is_dataclass(hints[field.name])
    }
    return kind(**(dict(data) | nested))
