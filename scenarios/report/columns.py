"""Columns of a report page: single runs, or many runs combined."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.report.findings.run_findings import RunFindings, analyse_run, headline
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, open_run, runs_in
from peopleboy.scenarios.scores.by_tracker import check_same_scenes
from peopleboy.scenarios.scores.evaluate_runs import evaluate_runs
from peopleboy.tracker.evaluation.evaluate import Scores
from peopleboy.tracker.evaluation.occlusion_scores import OccludedShares, Occlusion, score_occlusions
from peopleboy.wording import counted

MOST_BESIDE = 4  # columns that fit on paper


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Column:
    """One run, or several runs combined.

    Attributes:
        label: name that distinguishes it from other columns.
        runs: at least one run.
        scores: scores of each run.
        notes: caveats of the scores, one line each, from the first run that has any.
        occlusions: full occlusions of each run.
    """

    label: str
    runs: tuple[RunFindings, ...]
    scores: tuple[Scores, ...]
    notes: tuple[str, ...]
    occlusions: tuple[tuple[Occlusion, ...], ...]

    @property
    def is_single(self) -> bool:
        """Whether the column has a single run."""
        return len(self.runs) == 1

    @property
    def found(self) -> RunFindings:
        """The first run."""
        return self.runs[0]

    @property
    def headline(self) -> str:
        """Summary of the findings in a sentence."""
        return headline(self.runs)

    def by_badness(self) -> list[tuple[RunFindings, Scores]]:
        """Return runs with scores, the worst first: by numbers on another person, then by lost identities."""
        pairs = zip(self.runs, self.scores, strict=True)
        return sorted(
            pairs, key=lambda pair: (-len(pair[0].transfers), -len(pair[0].lost), pair[1].mot.identity.idf1)
        )


def read_columns(paths: Sequence[Path]) -> list[Column]:
    """Read the columns of a page: each path is the folder of a run, or a folder of many runs.

    More than `MOST_BESIDE` paths are grouped by tracker.

    Raises:
        BadInput: a folder has no complete run or is given twice, there are too many trackers for one page, or
            runs of the same scenario and seed show different scenes.
    """
    folders = [runs_in(path) for path in paths]
    _refuse_repeats([folder for of_path in folders for folder in of_path])
    groups = [[open_run(folder) for folder in of_path] for of_path in folders]
    if len(paths) > MOST_BESIDE:
        by_tracker: dict[str, list[FinishedRun]] = {}
        for run in (run for group in groups for run in group):
            by_tracker.setdefault(run.about.tracker, []).append(run)
        groups = list(by_tracker.values())
    if len(groups) > MOST_BESIDE:
        raise BadInput(f"report: runs of {len(groups)} trackers; at most {MOST_BESIDE} fit side by side")
    check_same_scenes(
        [{run.folder: (run.about.scenario, run.about.seed) for run in group} for group in groups]
    )
    labels = _labels(groups, paths)
    return [_column(label, group) for label, group in zip(labels, groups, strict=True)]


def are_same_scene(columns: Sequence[Column]) -> bool:
    """Return whether all columns are single runs of one scenario and seed."""
    titles = {column.found.run.title for column in columns}
    return all(column.is_single for column in columns) and len(titles) == 1


def lacking(columns: Sequence[Column]) -> list[str]:
    """Return a line for each column of which the page lacks content, since a scenario file is unreadable."""
    lines = []
    for column in columns:
        faults = [fault for fault in map(_fault, column.runs) if fault]
        if faults:
            more = f" (and {counted(len(faults) - 1, 'run')} more)" if len(faults) > 1 else ""
            lines.append(
                f"{faults[0]}{more}; the plan and images rendered again are missing; "
                "run the scenario again to get them"
            )
    return lines


def _fault(found: RunFindings) -> str:
    """Return why a run's scenario cannot be loaded; empty if it can."""
    try:
        _ = found.run.scenario
    except BadInput as error:
        return str(error)
    return ""


def _refuse_repeats(folders: Sequence[Path]) -> None:
    seen: set[Path] = set()
    for folder in folders:
        if folder.resolve() in seen:
            raise BadInput(f"{folder}: is given twice; give each run once")
        seen.add(folder.resolve())


def _column(label: str, runs: Sequence[FinishedRun]) -> Column:
    found = tuple(analyse_run(run) for run in runs)
    scored = evaluate_runs([run.folder for run in runs])
    return Column(
        label=label,
        runs=found,
        scores=tuple(people.scores for people in scored),
        notes=next((people.notes for people in scored if people.notes), ()),
        occlusions=tuple(_occlusions(of_run) for of_run in found),
    )


def _occlusions(found: RunFindings) -> tuple[Occlusion, ...]:
    """Score the full occlusions of a run; its ground truth file omits people outside the image."""
    truth, tracks = found.boxes
    occluded = {person.id: person.occluded for person in found.people}
    rows = zip(truth.id.tolist(), truth.frame.tolist(), strict=True)
    hidden = np.array([occluded[person][frame - 1] for person, frame in rows], np.float64)
    return tuple(score_occlusions(truth, tracks, OccludedShares(hidden, found.run.rate_hz)))


def _labels(groups: Sequence[Sequence[FinishedRun]], paths: Sequence[Path]) -> list[str]:
    """Label columns by the first property in which they differ: tracker, scenario or folder."""
    choices = [
        [_common([run.about.tracker for run in group]) for group in groups],
        [g[0].title if len(g) == 1 else _common([run.about.scenario for run in g]) for g in groups],
    ]
    if len(paths) == len(groups):
        choices += [[path.name for path in paths], [str(path) for path in paths]]
    for labels in choices:
        if all(labels) and len(set(labels)) == len(labels):
            return labels
    return [f"{number}: {group[0].folder}" for number, group in enumerate(groups, start=1)]


def _common(values: Sequence[str]) -> str:
    return values[0] if len(set(values)) == 1 else ""
