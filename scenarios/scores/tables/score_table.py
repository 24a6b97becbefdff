"""A table of metrics for a paper: a row for each tracker, and for each difference from the first tracker."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.bootstrap import PairedDifference
from peopleboy.scenarios.scores.by_tracker import Groups, ScoredRun, differences
from peopleboy.scenarios.scores.people_ranges import OCCLUSION_RANGES, VISIBLE_RANGES, PeopleRange
from peopleboy.scenarios.scores.summaries import Summary, summarise
from peopleboy.tracker.evaluation.table import Figure, parse_figures

PAPER_FIGURES: Final = parse_figures("HOTA, DetA, AssA, IDF1, MOTA, IDSW")
"""Metrics of a table unless others are asked for."""

ALL: Final = "all"
"""Name of the part that contains everything."""


class Per(StrEnum):
    """What a part of a table is about."""

    SCENARIO = "scenario"
    SEQUENCE = "sequence"
    RUN = "run"
    VISIBLE_FRACTION = "visible-fraction"
    OCCLUSION_TIME = "occlusion-time"


@dataclass(frozen=True, slots=True)
class TableRow:
    """Metrics of a tracker, or their differences from another tracker.

    Attributes:
        part: scenario, sequence, run or people that the row is about; `ALL` for everything.
        tracker: name of the tracker.
        other: tracker that it is compared with; empty for its own metrics.
        runs: number of runs, or of pairs of runs.
        cells: a value for each metric.
    """

    part: str
    tracker: str
    other: str
    runs: int
    cells: Sequence[Summary | PairedDifference]

    @property
    def name(self) -> str:
        """Name of the tracker, or of the difference."""
        return f"{self.tracker} - {self.other}" if self.other else self.tracker


@dataclass(frozen=True, slots=True)
class ScoreTable:
    """A table of metrics.

    Attributes:
        per: what the parts are about; None for a table of one part.
        figures: the metrics, one a column.
        rows: the rows, by part.
    """

    per: Per | None
    figures: Sequence[Figure]
    rows: Sequence[TableRow]

    def best(self, row: TableRow, column: int) -> bool:
        """Return whether a tracker has the best mean of its part in a column, among several trackers.

        Means over different numbers of runs have no best.
        """
        figure = self.figures[column]
        if row.other or not figure.better:
            return False
        rivals = [one for one in self.rows if one.part == row.part and not one.other]
        if len({one.runs for one in rivals}) > 1:
            return False
        means = {one.tracker: figure.better * _mean(one.cells[column]) for one in rivals}
        known = [mean for mean in means.values() if not math.isnan(mean)]
        return len(known) > 1 and means[row.tracker] == max(known) > min(known)


def _mean(cell: Summary | PairedDifference) -> float:
    return cell.interval.mean


def make_table(parts: Mapping[str, Groups], figures: Sequence[Figure], per: Per | None = None) -> ScoreTable:
    """Summarise the runs of each part and tracker, and compare trackers over the scenes that they share."""
    return ScoreTable(
        per, figures, [row for part, groups in parts.items() for row in _rows(part, groups, figures)]
    )


def _rows(part: str, groups: Groups, figures: Sequence[Figure]) -> Iterator[TableRow]:
    for tracker, runs in groups.items():
        yield TableRow(part, tracker, "", len(runs), summarise([run.scores for run in runs], figures))
    for one in differences(groups, figures):
        if one.pairs > 1:  # a single pair says nothing that the two rows do not
            cells = [one.figures[figure.name] for figure in figures]
            yield TableRow(part, one.tracker, one.other, one.pairs, cells)


def split_runs(groups: Groups, per: Per) -> dict[str, Groups]:
    """Split runs into parts by scenario, sequence or run, and add the part of all.

    Raises:
        BadInput: a run does not state its scenario.
    """
    name = _NAMES[per]
    found: dict[str, dict[str, list[ScoredRun]]] = {}
    for tracker, runs in groups.items():
        for run in runs:
            found.setdefault(name(run), {}).setdefault(tracker, []).append(run)
    return {**found, ALL: groups}


def _scenario(run: ScoredRun) -> str:
    return _scene(run)[0]


def _sequence(run: ScoredRun) -> str:
    return "{}-{}".format(*_scene(run))


def _scene(run: ScoredRun) -> tuple[str, int]:
    if run.scene is None:
        raise BadInput(
            f"{run.name}: does not state its scenario and seed; give --per run, or leave --per out"
        )
    return run.scene


_NAMES: Final[Mapping[Per, Callable[[ScoredRun], str]]] = {
    Per.SCENARIO: _scenario,
    Per.SEQUENCE: _sequence,
    Per.RUN: lambda run: run.name,
}


def score_parts(score: Callable[[PeopleRange | None], Groups], per: Per | None) -> dict[str, Groups]:
    """Score the runs in parts, and all together.

    Args:
        score: scores the runs, for people in a range or for all.
        per: what the parts are about; None for all together alone. Runs without a person in a range have no
            part in it.

    Raises:
        BadInput: as `score`, or a run does not state its scenario.
    """
    whole = score(None)
    if per is None:
        return {ALL: whole}
    if per in _NAMES:
        return split_runs(whole, per)
    ranges = VISIBLE_RANGES if per is Per.VISIBLE_FRACTION else OCCLUSION_RANGES
    parts = {one.name: keep_targets(score(one)) for one in ranges}
    return {**{name: groups for name, groups in parts.items() if groups}, ALL: whole}


def keep_targets(groups: Groups) -> Groups:
    """Return the runs that have a person to be found, and the trackers that have such runs."""
    kept = {tracker: [run for run in runs if run.scores.counts.targets] for tracker, runs in groups.items()}
    return {tracker: runs for tracker, runs in kept.items() if runs}
