"""What stands side by side on a page: single runs, or many runs taken together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.report.findings.finished_run import FinishedRun, read_finished
from peopleboy.scenarios.report.findings.summary import Outcome, headline, headline_of_many, look_into
from peopleboy.scenarios.scores.evaluate_runs import evaluate_runs, runs_in
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.occlusion_scores import Occlusion, score_occlusions
from peopleboy.wording import counted

MOST_BESIDE = 4  # columns that a table can hold on paper


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Column:
    """One run, or several that are taken together.

    Attributes:
        label: by which it is told from the others.
        outcomes: at least one.
        scores: of each run.
        occlusions: total ones, of each run.
    """

    label: str
    outcomes: tuple[Outcome, ...]
    scores: tuple[Scores, ...]
    occlusions: tuple[tuple[Occlusion, ...], ...]

    @property
    def is_single(self) -> bool:
        """Whether it is one run only."""
        return len(self.outcomes) == 1

    @property
    def run(self) -> FinishedRun:
        """Its first run."""
        return self.outcomes[0].run

    @property
    def headline(self) -> str:
        """What came out, in a sentence."""
        return headline(self.outcomes[0]) if self.is_single else headline_of_many(self.outcomes)

    def by_badness(self) -> list[tuple[Outcome, Scores]]:
        """Its runs with their scores, most lost identities first."""
        pairs = zip(self.outcomes, self.scores, strict=True)
        return sorted(pairs, key=lambda pair: (-len(pair[0].lost), pair[1].mot.identity.idf1))

    def name_of(self, person: int) -> str:
        """Name a person of the first run."""
        return next(story.name for story in self.outcomes[0].stories if story.id == person)


def read_columns(paths: Sequence[Path]) -> list[Column]:
    """Read what stands side by side: each path is a run's folder, or one that holds those of many runs.

    More than `MOST_BESIDE` paths are taken together by their trackers.

    Raises:
        BadInput: a folder holds no complete run or is given twice, or there are too many trackers to stand
            side by side.
    """
    folders = [runs_in(path) for path in paths]
    _refuse_repeats([folder for of_path in folders for folder in of_path])
    groups = [[read_finished(folder) for folder in of_path] for of_path in folders]
    if len(paths) > MOST_BESIDE:
        by_tracker: dict[str, list[FinishedRun]] = {}
        for run in (run for group in groups for run in group):
            by_tracker.setdefault(str(run.about["tracker"]), []).append(run)
        groups = list(by_tracker.values())
    if len(groups) > MOST_BESIDE:
        raise BadInput(f"report: runs of {len(groups)} trackers; at most {MOST_BESIDE} stand side by side")
    labels = _labels(groups, paths)
    return [_column(label, group) for label, group in zip(labels, groups, strict=True)]


def are_same_scene(columns: Sequence[Column]) -> bool:
    """Tell whether all are single runs of one scenario and seed."""
    return all(column.is_single for column in columns) and len({column.run.name for column in columns}) == 1


def lacking(columns: Sequence[Column]) -> list[str]:
    """Say, in a line a column, what a page cannot show since a scenario file is missing or spoilt."""
    lines = []
    for column in columns:
        faults = [outcome.run.fault for outcome in column.outcomes if outcome.run.fault]
        if faults:
            more = f" (and {counted(len(faults) - 1, 'run')} more)" if len(faults) > 1 else ""
            lines.append(
                f"{faults[0]}{more}; so no plan is drawn and no image rendered again; "
                "run the scenario again for them"
            )
    return lines


def _refuse_repeats(folders: Sequence[Path]) -> None:
    seen: set[Path] = set()
    for folder in folders:
        if folder.resolve() in seen:
            raise BadInput(f"{folder}: is given twice; give each run once, or another one to compare with")
        seen.add(folder.resolve())


def _column(label: str, runs: Sequence[FinishedRun]) -> Column:
    outcomes = tuple(look_into(run) for run in runs)
    return Column(
        label=label,
        outcomes=outcomes,
        scores=tuple(evaluate_runs([run.folder for run in runs])),
        occlusions=tuple(_occlusions(outcome) for outcome in outcomes),
    )


def _occlusions(outcome: Outcome) -> tuple[Occlusion, ...]:
    """Score the total occlusions of a run; its truth file has nobody who is outside the image."""
    run = outcome.run
    occluded = {story.id: story.occluded for story in outcome.stories}
    rows = zip(run.truth.id.tolist(), run.truth.frame.tolist(), strict=True)
    hidden = np.array([occluded[person][frame - 1] for person, frame in rows], np.float64)
    in_image = np.isfinite(hidden)
    return tuple(score_occlusions(run.truth, run.tracks, np.nan_to_num(hidden), in_image, run.rate_hz))


def _labels(groups: Sequence[Sequence[FinishedRun]], paths: Sequence[Path]) -> list[str]:
    """Name columns by the first thing in which they differ: tracker, scenario, folder."""

    def common(group: Sequence[FinishedRun], key: str) -> Any:
        values = {str(run.about[key]) for run in group}
        return values.pop() if len(values) == 1 else ""

    choices = [
        [common(group, "tracker") for group in groups],
        [group[0].name if len(group) == 1 else common(group, "scenario") for group in groups],
    ]
    if len(paths) == len(groups):
        choices += [[path.name for path in paths], [str(path) for path in paths]]
    for labels in choices:
        if all(labels) and len(set(labels)) == len(labels):
            return labels
    return [f"{number}: {group[0].folder}" for number, group in enumerate(groups, start=1)]
