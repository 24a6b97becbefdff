"""Runs by their trackers: those of one are taken together, those of several compared pair by pair."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import read_run
from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap
from peopleboy.scenarios.scores.evaluate_runs import evaluate_runs
from peopleboy.scenarios.scores.same_scenes import Scene, check_same_scenes
from peopleboy.scenarios.scores.yardstick import Yardstick
from peopleboy.tracker.evaluation.box_matching import MIN_VISIBLE
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.table import FIGURES, spread, to_json
from peopleboy.tracker.footage.box_kinds import BoxKind


@dataclass(frozen=True, slots=True, eq=False)
class ScoredRun:
    """The scores of a run.

    Attributes:
        name: of its folder, or of the file that its tracks are in.
        tracker: whose tracks they are.
        scene: what there was to be seen; None where nobody knows.
        scores: of the tracks.
        by: what boxes were held against; None for squares on the floor, footage and files.
        notes: what whoever reads the scores must know, a line each.
    """

    name: str
    tracker: str
    scene: Scene | None
    scores: Scores
    by: Yardstick | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Difference:
    """How a tracker differs from another one in the scenes that both saw.

    Attributes:
        tracker: whose figures are higher where a difference is positive.
        other: from whose figures they differ.
        pairs: how many scenes there are.
        figures: mean of the differences and its interval, by the figure's name.
    """

    tracker: str
    other: str
    pairs: int
    figures: Mapping[str, Interval]


Groups = Mapping[str, Sequence[ScoredRun]]


def score_by_tracker(
    folders: Sequence[Path],
    min_visible: float = MIN_VISIBLE,
    camera: str | None = None,
    boxes: BoxKind | None = None,
) -> Groups:
    """Score the runs in these folders, and sort them by tracker, in the order in which these come first.

    Args:
        folders: of the runs.
        min_visible: as for `evaluate_runs`.
        camera: the same.
        boxes: the same.

    Raises:
        BadInput: as for `evaluate_runs`, or a run does not say what its tracker was, or trackers saw
            different scenes of one name.
    """
    groups: dict[str, list[ScoredRun]] = {}
    for folder, people in zip(folders, evaluate_runs(folders, min_visible, camera, boxes), strict=True):
        about = read_run(folder)
        tracker, seed = about.get("tracker"), about.get("seed")
        if not isinstance(tracker, str):
            raise BadInput(f"{folder / 'run.json'}: tracker: must be a name, got {tracker!r}; run it again")
        name = about.get("scenario", about.get("footage"))
        scene = (name, seed) if isinstance(name, str) and isinstance(seed, int) else None
        run = ScoredRun(str(folder), tracker, scene, people.scores, people.by, people.notes)
        groups.setdefault(tracker, []).append(run)
    check_same_scenes([{Path(run.name): run.scene for run in runs} for runs in groups.values()])
    return groups


def differences(groups: Groups) -> list[Difference]:
    """Compare every tracker but the first with the first, over the scenes that each of the two saw once."""
    (first, of_first), *others = groups.items()
    return [_difference(tracker, runs, first, of_first) for tracker, runs in others]


def figures_of_all(groups: Groups) -> dict[str, Any]:
    """Give all figures as JSON can hold them: of each run, of each tracker, and how trackers differ."""
    return {
        "trackers": {tracker: _together(runs) for tracker, runs in groups.items()},
        "differences": [
            {
                "tracker": one.tracker,
                "from": one.other,
                "pairs": one.pairs,
                "figures": {
                    name: None if math.isnan(i.mean) else i.to_json() for name, i in one.figures.items()
                },
            }
            for one in differences(groups)
        ],
    }


def _together(runs: Sequence[ScoredRun]) -> dict[str, Any]:
    scores = [run.scores for run in runs]
    over = {row.figure.name: row for row in spread(scores)}
    return {
        "all_frames": to_json(combine(scores)),
        "mean_of_runs": {name: None if math.isnan(row.mean) else row.mean for name, row in over.items()},
        "deviation": {name: None if math.isnan(row.sd) else row.sd for name, row in over.items()},
        "runs": [_alone(run) for run in runs],
    }


def _alone(run: ScoredRun) -> dict[str, Any]:
    scene, seed = (None, None) if run.scene is None else run.scene
    by = {} if run.by is None else {"scored_by": run.by.to_json()}
    about = {"run": run.name, "scene": scene, "seed": seed, "notes": list(run.notes)}
    return about | {"figures": by | to_json(run.scores)}


def _difference(
    tracker: str, runs: Sequence[ScoredRun], other: str, of_other: Sequence[ScoredRun]
) -> Difference:
    ours, theirs, rng = _once(runs), _once(of_other), np.random.default_rng(0)
    scenes = [scene for scene in theirs if scene in ours]
    return Difference(
        tracker,
        other,
        len(scenes),
        {
            figure.name: bootstrap([figure.of(ours[s]) - figure.of(theirs[s]) for s in scenes], rng)
            for figure in FIGURES
        },
    )


def _once(runs: Sequence[ScoredRun]) -> Mapping[Scene, Scores]:
    """Give the scores by scene, of those scenes that there is one run of."""
    found: dict[Scene, list[Scores]] = {}
    for run in runs:
        if run.scene is not None:
            found.setdefault(run.scene, []).append(run.scores)
    return {scene: scores[0] for scene, scores in found.items() if len(scores) == 1}
