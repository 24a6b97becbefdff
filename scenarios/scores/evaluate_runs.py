"""Scores of finished runs, from the files in their folders."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import read_run
from peopleboy.scenarios.run_folder.run_files import check_end, check_whole
from peopleboy.scenarios.scores.people_scores import score_camera, score_people
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.evaluation.uncounted import MIN_VISIBLE
from peopleboy.tracker.footage.truth_files import GivenTruth, find_truth, load_truth
from peopleboy.tracker.frame import THERMAL


def evaluate_files(
    truth: Path,
    tracks: Path,
    frames: int | None = None,
    min_visible: float = MIN_VISIBLE,
    note: Callable[[str], None] = lambda _: None,
) -> Scores:
    """Score MOTChallenge tracks against truth of any format that footage comes with.

    People of whom no more than min_visible is seen do not count. Figures that need everybody are undefined
    where the truth has one person alone. What was taken as something else than it is goes to `note`.
    """
    given = load_truth(truth, None)
    for text in given.notes:
        note(text)
    return _score(given, read_tracks(tracks), frames, min_visible)


def evaluate_runs(
    folders: Sequence[Path], min_visible: float = MIN_VISIBLE, camera: str = THERMAL
) -> list[Scores]:
    """Score the runs in these folders, one by one; min_visible as for files.

    Boxes are scored in the image of a camera; those of the thermal one come with places on the floor.

    Raises:
        BadInput: a folder holds no run, or one that was cut off, or whose files do not belong together, or
            one of footage without truth.
    """
    if camera == THERMAL:
        return [_evaluate_run(folder, min_visible) for folder in folders]
    return [score_camera(folder, camera, read_run(folder)["frames"], min_visible) for folder in folders]


def _evaluate_run(folder: Path, min_visible: float) -> Scores:
    about, truth = read_run(folder), find_truth(folder)
    if truth is None:
        raise BadInput(f"{folder}: has no truth to score against; give --truth with --tracks")
    given, found = load_truth(truth, None), read_tracks(folder / "tracks.txt")
    check_end(given.truth, truth, about["frames"])
    check_end(found, folder / "tracks.txt", about["frames"])
    check_whole(folder, given.truth, found)
    if (folder / "truth.parquet").is_file():
        return score_people(folder, given.truth, found, about["frames"], min_visible)
    return _score(given, found, about["frames"], min_visible)


def _score(given: GivenTruth, found: TrackBoxes, frames: int | None, min_visible: float) -> Scores:
    return evaluate(given.truth, found, frames=frames, min_visible=min_visible, is_single=given.is_single)
