"""How well people were found in a run: in the images of its cameras, and on the floor."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import cameras_of
from peopleboy.scenarios.run_folder.on_floor import (
    BELIEFS,
    PEOPLE,
    POSE,
    as_squares,
    is_on_floor_alone,
    places_of_people,
    places_of_tracks,
)
from peopleboy.scenarios.run_folder.run_files import read_table
from peopleboy.scenarios.run_folder.tables import ROBOT, TRACKS, TRUTH
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.evaluation.uncounted import MIN_VISIBLE


def score_people(
    folder: Path, truth: TrueBoxes, tracks: TrackBoxes, frames: int, min_visible: float = MIN_VISIBLE
) -> Scores:
    """Score the tracks of a run: their boxes in the thermal image, and where they say that people stand.

    A tracker that gave no box of anybody, but places, is scored on the floor alone: everybody is a square
    there (`floor_squares`), and all figures of boxes are those of squares.

    Args:
        folder: of the run, with its tables.
        truth: who is where in the thermal image.
        tracks: the boxes that the tracker gave in it.
        frames: how many.
        min_visible: people of whom at most this fraction is visible do not count.
    """
    robot = read_table(folder / "robot.parquet", ROBOT, POSE)
    people = read_table(folder / "truth.parquet", TRUTH, PEOPLE)
    beliefs = read_table(folder / "tracks.parquet", TRACKS, BELIEFS)
    if is_on_floor_alone(beliefs):
        truth, tracks = as_squares(folder, people, beliefs, robot)
    return evaluate(
        truth,
        tracks,
        frames=frames,
        min_visible=min_visible,
        standing=places_of_people(people, robot),
        believed=places_of_tracks(beliefs),
    )


def score_camera(folder: Path, camera: str, frames: int, min_visible: float = MIN_VISIBLE) -> Scores:
    """Score the boxes that the tracker of a run gave in the image of a further camera.

    In a panorama, boxes go on over the seam.

    Raises:
        BadInput: there are none.
    """
    paths = folder / "truth" / f"{camera}.gt.txt", folder / "tracks" / f"{camera}.txt"
    for path in paths:
        if not path.is_file():
            raise BadInput(f"{path}: there is no such file; no boxes were given in camera {camera!r}")
    around = around_px(cameras_of(folder)[camera].camera)
    truth, tracks = replace(read_truth(paths[0]), around_px=around), read_tracks(paths[1])
    return evaluate(truth, tracks, frames=frames, min_visible=min_visible)
