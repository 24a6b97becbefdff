"""Experiments with a depth camera, of the thesis on situation awareness: chapter 4 and appendix B."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiment import Floats, Line, Row, Samples, as_columns, mean
from peopleboy.studies.reproductions.experiments.drive_scores import RADIUS_M, TrackingRecord
from peopleboy.studies.reproductions.experiments.drive_tracking import (
    CHOICES,
    DEFAULT,
    LITERAL,
    NO_CONNECTOR,
    NO_ODOMETRY,
    PRINTED_CHOICES,
    SETS,
    TURNS,
    set_name,
    watch_drive,
    watch_legs,
)
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.statistics import bootstrap_interval
from peopleboy.studies.reproductions.units import Measurement, Unit

ALL, MEASURED = "all", "measured"
MAIN: Final = (DEFAULT, LITERAL)
ABLATED: Final = (4, 6, 7, 10, 11, 12)
"""Numbers of the sets for comparing trackers that differ in one setting."""
NOISIEST: Final = 3.0
SOURCE_NOISE: Final = 4.0
"""Scale of the depth noise that is nearest to the source's: 5.7 at 3.5 m, and 3.5 at 10 m."""
_FOLLOWED: Final = 2  # number of the set in which the robot follows a person
_BY_NOISE: Final = {1.0: CHOICES, SOURCE_NOISE: PRINTED_CHOICES}  # trackers of ablations
_RANGES_M: Final = {"up to 3 m": (0.0, 3.0), "3 to 5 m": (3.0, 5.0), "5 to 10 m": (5.0, 10.0)}

Value = Callable[[TrackingRecord], float]
Drives = Mapping[str, Sequence[Result]]
"""Results of trackers, by scenario, one per seed."""


def tracked(record: TrackingRecord) -> Row:
    """Return table 4.1's values."""
    return {
        "images": record.frames,
        "FP per image": record.false_per_frame(),
        "TP": record.found(),
        "FN": record.missed,
        "rate": record.rate(),
        "switches": record.switches,
    }


def compared(record: TrackingRecord) -> Row:
    """Return the values by which trackers are compared."""
    return {
        "rate": record.rate(),
        "FP per image": record.false_per_frame(),
        "switches": record.switches,
        "mean [m]": mean(record.error_m),
        "median [m]": median(record.error_m),
        "ms": record.ms,
    }


def errors_along(record: TrackingRecord) -> Row:
    """Return table B.1's errors, sideways (x) and along the robot's axis (z), against the surface."""
    off = np.abs(record.hits[:, 5:7])
    z, x = off[np.isfinite(off).all(axis=1)].T
    return {"x [m]": mean(x), "z [m]": mean(z), "sd x [m]": float(x.std()), "sd z [m]": float(z.std())}


def position(record: TrackingRecord, *, place: str, radius_m: float) -> Row:
    """Return how well positions are found within a radius of the body's middle, or of the surface seen."""
    off = record.error_m if place == "body" else record.surface_error_m
    off = off[off <= radius_m]
    return {
        "rate": record.rate(radius_m),
        "FP per image": record.false_per_frame(radius_m),
        "mean [m]": mean(off),
        "median [m]": median(off),
    }


def recall(record: TrackingRecord, *, band: int) -> Row:
    """Return the pre-detection's recall of people by how much of them is hidden."""
    return {"recall": float(record.size_recall[band])}


def false_sizes(record: TrackingRecord) -> Row:
    """Return the pre-detection's false alarms."""
    return {"false sizes per image": record.false_sizes / record.frames}


COLUMNS: Final[Mapping[str, Callable[..., Row]]] = {
    one.__name__: one for one in (tracked, compared, errors_along, position, recall, false_sizes)
}


def drives(
    using: Measurement,
    *,
    groups: Mapping[str, Mapping[str, Any]] | None = None,
    columns: str = "",
    drives: str = "sets",
    by_set: bool = False,
) -> Samples:
    """Score trackers on drives, one value per seed.

    Args:
        using: the plan and stored results.
        groups: `tracker`, unless default and literal, `scale` of the depth noise, and `columns` with their
            arguments.
        columns: one of `COLUMNS`.
        drives: "sets", "ablated" for ablations, or "turns" for drives with much rotation.
        by_set: whether there is a group for each set, and one for all of them.
    """
    declared = {name: {"columns": columns, **own} for name, own in (groups or {}).items()}
    if by_set:
        sets = {set_name(number): (number,) for number in using.plan.sets} | {ALL: using.plan.sets}
        declared = {name: {"columns": columns, "numbers": numbers} for name, numbers in sets.items()}
    played = play_drives(using, {name: (drives, own.get("scale", 1.0)) for name, own in declared.items()})
    found = {}
    for name, own in declared.items():
        rest = {key: one for key, one in own.items() if key not in ("columns", "tracker", "scale", "numbers")}
        measure = partial(COLUMNS[own["columns"]], **rest)
        scenarios = [SETS[number - 1] for number in own.get("numbers", ())] or played[name]
        for tracker in (own["tracker"],) if "tracker" in own else MAIN:
            records = by_seed({one: played[name][one] for one in scenarios}, tracker)
            found[Line(name, MEASURED if "tracker" in own else tracker)] = as_columns(map(measure, records))
    return found


_WANTED: Final[Mapping[str, Value]] = {
    "rate": TrackingRecord.rate,
    "FP per image": TrackingRecord.false_per_frame,
    "error, mean [m]": lambda record: mean(record.error_m),
    "error, median [m]": lambda record: median(record.error_m),
    "recall of the pre-detection, hidden < .1": lambda record: float(record.size_recall[0]),
    "false sizes per image": lambda record: record.false_sizes / record.frames,
}


def goals(using: Measurement) -> Samples:
    """Measure the goals of this project: values with 95 % intervals over seeds."""
    kinds = {"sets": ("sets", 1.0), "noisy": ("ablated", NOISIEST), "turns": ("turns", 1.0)}
    played = play_drives(using, kinds)
    everything = by_seed(played["sets"], DEFAULT)
    rows = {name: _with_interval(everything, _joined(value)) for name, value in _WANTED.items()}
    by_set = [by_seed({one: runs}, DEFAULT) for one, runs in played["sets"].items()]
    rows["rate of the worst set"] = _with_interval(list(zip(*by_set, strict=True)), _worst_rate)
    rows["rate, noise x 3"] = _with_interval(by_seed(played["noisy"], DEFAULT), _joined(TrackingRecord.rate))
    pairs = zip(*(by_seed(played["turns"], name) for name in (NO_ODOMETRY, DEFAULT)), strict=True)
    rows["switches a run in turns, saved by odometry"] = _with_interval(list(pairs), _saved_switches)
    return {Line(name, DEFAULT): row for name, row in rows.items()}


def _joined(value: Value) -> Callable[[Sequence[TrackingRecord]], float]:
    return lambda records: value(TrackingRecord.joined(records))


def _worst_rate(seeds: Sequence[Sequence[TrackingRecord]]) -> float:
    return float(np.nanmin([TrackingRecord.joined(records).rate() for records in zip(*seeds, strict=True)]))


def _saved_switches(pairs: Sequence[Sequence[TrackingRecord]]) -> float:
    return sum(without.switches - with_it.switches for without, with_it in pairs) / len(pairs)


def _with_interval(parts: Sequence[Any], value: Callable[[Sequence[Any]], float]) -> dict[str, Floats]:
    numbers = (value(parts), *bootstrap_interval(parts, value))
    return {name: np.array([number]) for name, number in zip(("figure", "from", "to"), numbers, strict=True)}


def legs(using: Measurement) -> Samples:
    """Measure the share of images in which the person is found, by range, with depth and with legs."""
    run = legs_run(using)
    return {
        Line(group, name): as_columns([{"rate": _found(run["truth"], run[key], *limits)}])
        for group, limits in _RANGES_M.items()
        for name, key in ((DEFAULT, "depth"), ("legs", "legs"))
    }


def legs_run(using: Measurement) -> Result:
    """Return the drive in which a person is also tracked by legs."""
    (run,) = using.results([Unit.of(watch_legs, SETS[_FOLLOWED - 1], using.plan.drive_s)])
    return run


def _found(
    truth: Sequence[Sequence[float]], tracked: Sequence[Sequence[float]], nearest_m: float, farthest_m: float
) -> float:
    """Return the share of images in which a clearly visible person in range is located within 1 m."""
    places: dict[int, list[Sequence[float]]] = {}
    for frame, _, *place in tracked:
        places.setdefault(int(frame), []).append(place)
    wanted = [row for row in truth if row[6] and nearest_m <= row[4] < farthest_m]
    hits = [
        any(np.hypot(x - row[2], y - row[3]) <= RADIUS_M for x, y in places.get(int(row[0]), []))
        for row in wanted
    ]
    return mean(hits)


def play_drives(using: Measurement, wanted: Mapping[str, tuple[str, float]]) -> dict[str, Drives]:
    """Return drives of several kinds, each with scaled depth noise; all are requested at once."""
    units = {name: drive_units(using.plan, *kind) for name, kind in wanted.items()}
    using.results(unit for one in units.values() for several in one.values() for unit in several)
    return {name: using.grouped(one) for name, one in units.items()}


def drive_units(plan: Plan, kind: str, scale: float) -> dict[str, list[Unit]]:
    """Return the units of drives of a kind; ablated drives run all trackers, or those of a noise."""
    names: Sequence[str]
    if kind == "turns":
        scenarios, seeds, names = [TURNS], 2 * plan.drives, (DEFAULT, NO_ODOMETRY)
    elif kind == "sets":
        scenarios, seeds, names = [SETS[n - 1] for n in plan.sets], plan.drives, MAIN
    else:
        scenarios, seeds = [SETS[n - 1] for n in plan.sets if n in ABLATED], plan.ablated
        names = _BY_NOISE.get(scale, (DEFAULT, NO_CONNECTOR))
    return {
        one: [Unit.of(watch_drive, one, seed, names, scale, plan.drive_s) for seed in range(seeds)]
        for one in scenarios
    }


def by_seed(played: Drives, tracker: str) -> list[TrackingRecord]:
    """Return what a tracker did on drives, taken together by seed."""
    return [
        TrackingRecord.joined(TrackingRecord.of_plain(run[tracker]) for run in runs)
        for runs in zip(*played.values(), strict=True)
    ]


def median(errors: Floats) -> float:
    """Return the median of values (N,); NaN without values."""
    return float(np.median(errors)) if errors.size else float("nan")
