"""Build the tables of a page, with explanations for readers who do not know the metrics."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from statistics import fmean, stdev
from typing import Final, NamedTuple

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.loop.run_events import describe_move
from peopleboy.scenarios.report.charts.timeline_rows import THING
from peopleboy.scenarios.report.columns import Column
from peopleboy.scenarios.report.findings.run_findings import RunFindings, headline
from peopleboy.scenarios.report.findings.sentences import seconds, spoken
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.scores.bootstrap import bootstrap
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.drive_record import Row, ScoreRecord
from peopleboy.scenarios.scores.following_metrics import FollowingScore
from peopleboy.scenarios.scores.goal_metrics import GoalScore
from peopleboy.sim.truth.events import Move
from peopleboy.tracker.evaluation.occlusion_scores import LENGTHS_S, by_length, name_length
from peopleboy.tracker.evaluation.table import FIGURES, IF_KNOWN, Figure

LONGEST = 40  # most runs that are listed individually
_FEWEST_PAIRS = 3  # fewest runs of the same scenario and seed for an interval of their differences

# Name of the metric, its plain name, and its meaning for a first-time reader.
PLAIN: Final = (
    ("CR", "people found", "Share of all frames with a person to be found in which a box is on the person."),
    ("CP", "boxes on people", "Share of all boxes that are on a person. The others are false positives."),
    ("AA", "fit of the boxes", "Overlap of boxes with ground truth boxes; 100 means identical boxes."),
    ("IDF1", "identity", "How consistently a person keeps one number. Lost or swapped identities lower it."),
    ("HOTA", "overall", "Detection and association in one metric, as in public benchmarks."),
    ("MOTA", "few mistakes", "100 less all misses, false positives and switches; it can be negative."),
    ("IDSW", "switches", "How often the number of a person changed, even if only for a moment."),
    ("false_tracks", "false tracks", "Tracks that are never on a person."),
)  # fmt: skip
_SCORES: Final[Mapping[str, type[ScoreRecord]]] = {
    "goal": GoalScore,
    "following": FollowingScore,
    "corridor": CorridorScore,
    "comfort": ComfortScore,
}


class Head(NamedTuple):
    """The heading of a column of a table."""

    name: str
    kind: str = ""  # "n" for numbers, "row" for row headings, "meaning" for explanations
    label: str = ""  # prefix of a cell on narrow screens, which have no column headings


class Bad(NamedTuple):
    """A cell that shows something bad."""

    text: str


class PageTable(NamedTuple):
    """A table; each row has a cell for each heading."""

    heads: Sequence[Head]
    rows: Sequence[tuple[str | Bad, ...]]


def losses(found: RunFindings) -> PageTable:
    """List the losses of tracks, and their causes."""
    heads = (
        Head("time", "n"),
        Head("number", "n", "number"),
        Head("on", "row", "on"),
        Head("what happened"),
        Head("tracker's explanation", label="tracker's explanation:"),
        Head("afterwards"),
    )
    rows = [
        (
            *(seconds(loss.time_s), str(loss.track), spoken(loss.owner) or "no person", loss.why),
            *(loss.believed or "not known", Bad(loss.afterwards) if loss.is_bad else loss.afterwards),
        )
        for loss in found.losses
    ]
    return PageTable(heads, rows)


def runs_of(column: Column) -> PageTable:
    """List the runs of a column, the worst first."""
    names = ("found", "identity")
    heads = (Head("run", "row"), Head("found (CR)", "n", names[0]), Head("identity (IDF1)", "n", names[1]))
    rows = [
        (
            *(found.run.title, number(scores.thesis.cr, "%"), number(scores.mot.identity.idf1, "%")),
            Bad(headline([found])) if found.faults else headline([found]),
        )
        for found, scores in column.by_badness()[:LONGEST]
    ]
    return PageTable((*heads, Head("findings")), rows)


def occlusions(column: Column) -> PageTable:
    """List the full occlusions in the first run after which the person came back."""
    names = {person.id: spoken(person.name) for person in column.found.people}
    heads = ("from", "wholly hidden for", "number before", "after", "found again after")
    rows = []
    for one in column.occlusions[0]:
        before, after = ("none" if n is None else str(n) for n in (one.id_before, one.id_after))
        is_bad = one.id_before is not None and not one.is_kept
        start = seconds(column.found.run.time_s(one.start_frame))
        again = Bad(after) if is_bad else after
        rows.append(
            (names[one.person], start, seconds(one.duration_s), before, again, number(one.found_after_s, "s"))
        )
    return PageTable((Head("person", "row"), *(Head(name, "n", name) for name in heads)), rows)


def identities_kept(columns: Sequence[Column]) -> PageTable:
    """Count identities kept in each column, by duration of the full occlusion."""
    tables = [by_length([one for of_run in c.occlusions for one in of_run]) for c in columns]
    rows = []
    for index, (low, high) in enumerate(pairwise(LENGTHS_S)):
        cells = [f"{t[index].kept} of {t[index].occlusions}" if t[index].occlusions else "-" for t in tables]
        if any(cell != "-" for cell in cells):
            rows.append((name_length(low, high), *cells))
    return PageTable((Head("wholly hidden for", "row"), *_heads(columns)), rows)


def modes(found: RunFindings) -> PageTable:
    """List the robot's modes, and their reasons."""
    lines = [line for line in found.run.events if line.kind == "mode"]
    rows = tuple((seconds(line.time_s), line.other, line.why) for line in lines)
    return PageTable((Head("time", "n"), Head("mode", "row"), Head("why")), rows)


def moves(found: RunFindings) -> PageTable:
    """List the events of moved objects, and the people who moved them."""
    lines = [line for line in found.run.events if line.kind.startswith(THING)]
    rows = [
        (
            seconds(line.time_s if line.move is None else line.move.from_s),
            spoken(line.who),
            line.kind.removeprefix(THING) if line.move is None else f"moved {describe_move(line.move)}",
            spoken(line.other) or "no person",
            _from_to(line.move),
        )
        for line in lines
    ]
    heads = (
        Head("time", "n"),
        Head("thing", "row"),
        Head("what"),
        Head("by", label="by"),
        Head("from and to"),
    )
    return PageTable(heads, rows)


def _from_to(move: Move | None) -> str:
    """Format old and new position of an object in the world: x, y, and height of its base."""
    if move is None:
        return ""
    places = (", ".join(f"{value:.2f}" for value in place) for place in (move.from_m, move.to_m))
    return "({}) to ({}) m".format(*places)


def plain_figures(columns: Sequence[Column]) -> PageTable:
    """Show the most important metrics, with plain names."""
    by_name = {figure.name: figure for figure in FIGURES}
    chosen = [(f"{plain} ({name})", meaning, by_name[name]) for name, plain, meaning in PLAIN]
    return _figures(columns, [(name, meaning, f.unit, _values(columns, f)) for name, meaning, f in chosen])


def all_figures(columns: Sequence[Column]) -> PageTable:
    """Show every metric that is defined for some run, with its usual name.

    Latency is left to `evaluate`: the page of a run is the same each time that it is simulated.
    """
    every = [scores for column in columns for scores in column.scores]
    lasting = [f for f in FIGURES if f.group != "latency"]
    defined = [f for f in lasting if f.group not in IF_KNOWN or any(map(f.is_defined_for, every))]
    return _figures(columns, [(f.name, f.meaning, f.unit, _values(columns, f)) for f in defined])


def drive_figures(columns: Sequence[Column], group: str) -> PageTable:
    """Show the driving metrics of a group, `following`, `corridor` or `comfort`, if any run has them."""
    rows = [[_rows(found.run, group) for found in column.runs] for column in columns]
    first = next((of_run for column in rows for of_run in column if of_run), [])

    def value(of_run: Sequence[Row], name: str) -> float:
        return next((value for other, value, _, _ in of_run if other == name), math.nan)

    lines = [
        (name, meaning, unit, [[value(of_run, name) for of_run in column] for column in rows])
        for name, _, unit, meaning in first
    ]
    return _figures(columns, lines)


def number(value: float, unit: str = "") -> str:
    """Format a value."""
    return "-" if math.isnan(value) else f"{value:{_form(value, unit)}} {unit}".rstrip()


def _form(value: float, unit: str) -> str:
    return ".1f" if unit == "%" else ".0f" if value == int(value) else ".2f"


def _rows(run: FinishedRun, group: str) -> list[Row]:
    figures = run.metrics.get(group)
    if figures is None:
        return []
    score: Callable[..., ScoreRecord] = _SCORES[group]
    try:
        return score(**{name: math.nan if v is None else v for name, v in figures.items()}).rows()
    except (TypeError, ValueError, AttributeError) as error:
        path = run.folder / "metrics.json"
        raise BadInput(f"{path}: {group}: not the metrics of this version; run the scenario again") from error


def _values(columns: Sequence[Column], figure: Figure) -> list[list[float]]:
    return [[figure.of(scores) for scores in column.scores] for column in columns]


def _figures(
    columns: Sequence[Column], lines: Sequence[tuple[str, str, str, list[list[float]]]]
) -> PageTable:
    """Lay out metrics: name, meaning, unit, and the values of the runs of each column."""
    is_pair = len(columns) == 2
    heads = (Head("figure", "row"), *_heads(columns), *([Head("difference", "n", "difference")] * is_pair))
    rows = [
        (
            *(name, *(_cell(of, unit) for of in values)),
            *([_difference(columns, values, unit)] if is_pair else []),
            meaning,
        )
        for name, meaning, unit, values in lines
    ]
    return PageTable((*heads, Head("meaning", "meaning")), rows)


def _heads(columns: Sequence[Column]) -> list[Head]:
    is_one = len(columns) == 1 and columns[0].is_single
    return [Head("value" if is_one else column.label, "n", column.label) for column in columns]


def _cell(values: Sequence[float], unit: str) -> str:
    """Format one value, or mean and standard deviation over runs."""
    known = [value for value in values if not math.isnan(value)]
    if len(values) == 1 or not known:
        return number(known[0] if known else math.nan, unit)
    spread = f" ± {stdev(known):.1f}" if len(known) > 1 else ""
    return f"{fmean(known):.1f}{spread} {unit}".rstrip()


def _difference(columns: Sequence[Column], values: Sequence[Sequence[float]], unit: str) -> str:
    """Format second less first, over runs of the same scenario and seed; with an interval for enough runs."""
    one, other = (
        dict(zip((found.run.title for found in column.runs), of, strict=True))
        for column, of in zip(columns, values, strict=True)
    )
    both = [other[name] - one[name] for name in one if name in other]
    known = [value for value in both if not math.isnan(value)]
    if len(known) >= _FEWEST_PAIRS:
        interval = bootstrap(known, np.random.default_rng(0))
        return f"{interval.mean:+.1f} [{interval.low:+.1f}, {interval.high:+.1f}]"
    if known and len(both) == len(values[0]) == len(values[1]):
        return f"{fmean(known):+{_form(fmean(known), unit)}}"
    return "-"
