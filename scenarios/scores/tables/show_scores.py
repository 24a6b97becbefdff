"""Print tables of scores on the terminal."""

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from itertools import zip_longest
from typing import Final

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.scores.bootstrap import Interval, PairedDifference
from peopleboy.scenarios.scores.by_tracker import Groups, differences
from peopleboy.scenarios.scores.comfort_metrics import ComfortScore
from peopleboy.scenarios.scores.drive_record import Metric, Row
from peopleboy.scenarios.scores.summaries import summarise
from peopleboy.scenarios.scores.tables.drive_comparison import DriveComparison
from peopleboy.scenarios.scores.tables.score_table import ScoreTable
from peopleboy.scenarios.scores.tables.write_table import caption, table_cells
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.table import FIGURES, NEED_EVERYBODY, Figure, rows
from peopleboy.wording import counted

_WIDE: Final = 10_000  # [characters]


def print_scores(scores: Scores, who: str = "people", figures: Sequence[Figure] = FIGURES) -> None:
    """Print the metrics of one run, or of several combined, that the ground truth defines."""
    if scores.counts.partly_annotated:
        _console().print(f"{_single_person(scores)}\n", soft_wrap=True)
    table = _table(who, "figure", "value", "meaning")
    for row in rows(scores, figures):
        if row.figure.is_defined_for(scores):
            table.add_row(row.figure.name, _number(row.value, row.figure.unit), row.figure.meaning)
    _print(table)
    _print_unknown(scores, figures)


def print_drive(title: str, rows: Sequence[Row]) -> None:
    """Print driving metrics: of person following, corridor following or comfort."""
    table = _table(title, "figure", "value", "meaning")
    for name, value, unit, meaning in rows:
        table.add_row(name, _number(value, unit), meaning)
    _print(table)


def print_comfort(by_tracker: Mapping[str, ComfortScore]) -> None:
    """Print mean comfort metrics over the runs of each tracker; nothing if there are none."""
    if not by_tracker:
        return
    table = _table("comfort, means over runs", "figure", *by_tracker, "meaning")
    for lines in zip(*(score.rows() for score in by_tracker.values()), strict=True):
        name, _, unit, meaning = lines[0]
        table.add_row(name, *[_number(value, unit) for _, value, _, _ in lines], meaning)
    _print(table)


def print_comparison(found: DriveComparison) -> None:
    """Print the driving metrics of each controller, and their differences from the first one."""
    amount = f"{found.count} runs each: mean [95 % interval]" if found.count > 1 else "one run each"
    table = _table(
        f"{found.scenario}, {amount}",
        "figure",
        *found.runs,
        *[f"{controller} - {found.first}" for controller in found.differences],
    )
    for key, metric in found.metrics.items():
        means = [_mean(of_one[key], metric) if key in of_one else "-" for of_one in found.means.values()]
        apart = [
            _difference(of_one[key], metric.unit, metric.factor) for of_one in found.differences.values()
        ]
        table.add_row(metric.name, *means, *apart)
    console = _wide_console()
    console.print(table)
    about = f"{_how_they_differ(found.count)}\n" if found.differences else ""
    console.print(f"\n{about}", soft_wrap=True)


def print_runs(
    groups: Groups,
    who: str = "people",
    note: Callable[[str], None] = lambda _: None,
    figures: Sequence[Figure] = FIGURES,
) -> None:
    """Print the metrics of runs: combined for one tracker, side by side for several.

    Args:
        groups: the runs by their trackers.
        who: name of the targets in the tables' titles.
        note: called with the caveats of a tracker's metrics, once for all its runs.
        figures: the metrics to print.
    """
    if len(groups) > 1:
        _print_beside(groups, who, figures)
    else:
        ((tracker, runs),) = groups.items()
        if len(runs) == 1:
            print_scores(runs[0].scores, who, figures)
        else:
            _print_spread(tracker, [run.scores for run in runs], who, figures)
    print_notes(groups, note)


def print_notes(groups: Groups, note: Callable[[str], None]) -> None:
    """Call `note` with the caveats of each tracker's metrics, once for all its runs."""
    for tracker, runs in groups.items():
        for line in next((run.notes for run in runs if run.notes), ()):
            note(f"{tracker}: {line}")


def print_table(table: ScoreTable) -> None:
    """Print a table of metrics, with its parts apart."""
    heads, rows = table_cells(table)
    shown = Table(*heads[: len(heads) - len(table.figures)], box=None, pad_edge=False)
    for head in heads[len(heads) - len(table.figures) :]:
        shown.add_column(head, justify="right")
    for row, cells, after in zip_longest(table.rows, rows, table.rows[1:]):
        shown.add_row(*cells, end_section=after is not None and after.part != row.part)
    console = _wide_console()
    console.print(shown)
    console.print(f"\n{caption(table)}\n", soft_wrap=True)


def _print_spread(tracker: str, sequences: Sequence[Scores], who: str, figures: Sequence[Figure]) -> None:
    """Print metrics of several runs: of all frames combined, and mean, deviation and interval over runs."""
    title = f"{who}, {len(sequences)} runs of {tracker}"
    table = _table(title, "figure", "all frames", "mean of runs", "deviation", "95 % interval", "meaning")
    whole = combine(sequences)
    for one in summarise(sequences, figures):
        if not one.figure.is_defined_for(whole):
            continue
        numbers = [_number(value, one.figure.unit) for value in (one.whole, one.mean, one.sd)]
        between = f"{one.interval.low:.2f} to {one.interval.high:.2f}" if one.interval.is_known else "-"
        table.add_row(one.figure.name, *numbers, between, one.figure.meaning)
    _print(table)
    _print_unknown(whole, figures)


def _print_beside(groups: Groups, who: str, figures: Sequence[Figure]) -> None:
    """Print the metrics of each tracker's runs, and the differences over scenes that trackers share."""
    wholes = [combine([run.scores for run in runs]) for runs in groups.values()]
    compared = differences(groups, figures)
    table = _table(
        f"{who}, all frames of each tracker's runs",
        "figure",
        *[f"{tracker}, {counted(len(runs), 'run')}" for tracker, runs in groups.items()],
        *[f"{one.tracker} - {one.other}, {counted(one.pairs, 'pair')}" for one in compared],
    )
    for figure in figures:
        if not any(figure.is_defined_for(whole) for whole in wholes):
            continue
        values = [_number(figure.of(whole), figure.unit) for whole in wholes]
        apart = [_difference(one.figures[figure.name], figure.unit) for one in compared]
        table.add_row(figure.name, *values, *apart)
    console, pairs = _wide_console(), max(one.pairs for one in compared)
    console.print(table)
    console.print(f"\n{_how_they_differ(pairs)}{_by_what(groups)}\n", soft_wrap=True)


def _how_they_differ(pairs: int) -> str:
    if pairs == 0:
        return "No two runs have the same scenario and seed, so differences between trackers are unknown."
    text = "A difference is the mean over runs of the same scenario and seed"
    if pairs == 1:
        return f"{text}; one pair has no interval."
    return f"{text}, with its 95 % bootstrap interval and p of the Wilcoxon signed-rank test."


def _by_what(groups: Groups) -> str:
    """Describe the ground truth boxes of each tracker, if they are not the same for all."""
    held = {tracker: {str(run.by) for run in runs if run.by} for tracker, runs in groups.items()}
    if len(set().union(*held.values())) < 2:
        return ""
    references = [f"{tracker} against {' and '.join(sorted(by))}" for tracker, by in held.items() if by]
    return f" Trackers are scored against different ground truth boxes: {'; '.join(references)}."


def _difference(apart: PairedDifference, unit: str, factor: float = 1.0) -> str:
    interval = apart.interval
    if math.isnan(interval.mean):
        return "-"
    mean, low, high = (f"{factor * value:+.2f}" for value in (interval.mean, interval.low, interval.high))
    known = f" [{low}, {high}], p = {apart.p:.2g}" if interval.is_known else ""
    return f"{mean} {unit}".rstrip() + known


def _mean(interval: Interval, metric: Metric) -> str:
    mean, low, high = (metric.factor * value for value in (interval.mean, interval.low, interval.high))
    return _number(mean, metric.unit) + (f" [{low:.2f}, {high:.2f}]" if interval.is_known else "")


def _single_person(scores: Scores) -> str:
    """Summarise the tracking of the only annotated person."""
    mot, counts = scores.mot, scores.counts
    ids = f"{counts.true_tracks} {'id is' if counts.true_tracks == 1 else 'ids are'}"
    return (
        f"One id is on the annotated person in {_number(mot.identity.idr, '%')} of its frames (IoU 0.5), "
        f"any id in {_number(scores.thesis.cr, '%')}; {ids} on the person at some time."
    )


def _print_unknown(scores: Scores, figures: Sequence[Figure]) -> None:
    unknown = [figure.name for figure in figures if figure.name in NEED_EVERYBODY]
    if not scores.counts.partly_annotated or not unknown:
        return
    _console().print(
        f"Unknown: {', '.join(unknown)}. Only one person is annotated, so boxes elsewhere may be right "
        "or wrong.\n"
    )


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for column in columns:
        table.add_column(column, justify="left" if column in ("figure", "meaning") else "right")
    return table


def _number(value: float, unit: str) -> str:
    if math.isnan(value):
        return "-"
    digits = 2 if unit else 0 if value == int(value) else 2
    return f"{value:.{digits}f} {unit}".rstrip()


def _print(table: Table) -> None:
    console = _console()
    console.print(table)
    console.print()


def _console() -> Console:
    return Console() if sys.stdout.isatty() else Console(width=120)


def _wide_console() -> Console:
    """Return a console that does not wrap the rows of a table with many columns in a file or pipe."""
    return Console() if sys.stdout.isatty() else Console(width=_WIDE)
