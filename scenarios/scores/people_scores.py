"""How well people were found in a run: in the images of its cameras, and on the floor."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

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
from peopleboy.scenarios.scores.yardstick import Yardstick, notes_on
from peopleboy.sim.config import CONTROL_HZ
from peopleboy.tracker.evaluation.box_matching import MIN_VISIBLE
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.frame import THERMAL


@dataclass(frozen=True, slots=True, eq=False)
class ScoredPeople:
    """How well people were found, and by what that was told.

    Attributes:
        scores: the figures.
        by: what boxes were held against; None for squares on the floor, and for footage.
        notes: what whoever reads the figures must know, a line each.
    """

    scores: Scores
    by: Yardstick | None = None
    notes: tuple[str, ...] = ()


def score_people(
    folder: Path,
    held: tuple[TrueBoxes, TrackBoxes],
    frames: int,
    by: Yardstick,
    min_visible: float = MIN_VISIBLE,
) -> ScoredPeople:
    """Score the tracks of a run: their boxes in a camera's image, and where they say that people stand.

    Boxes are scored in frames in which the camera took an image: in others there is no truth to hold them
    against. Places come with the boxes of the thermal image. A tracker that gave no box of anybody there, but
    places, is scored on the floor alone: everybody is a square there (`floor_squares`), and all figures of
    boxes are those of squares.

    Args:
        folder: of the run, with its tables.
        held: `boxes_held` of the run: who was there, and the boxes that the tracker gave.
        frames: how many.
        by: what boxes are held against.
        min_visible: people of whom at most this fraction is visible do not count.

    Raises:
        BadInput: a table is missing or spoilt.
    """
    truth, tracks = held
    if by.camera != THERMAL:
        every = CONTROL_HZ // (cameras_of(folder)[by.camera].rate_hz or CONTROL_HZ)
        tracks = tracks.take((tracks.frame - 1) % every == 0)
        scores = evaluate(truth, tracks, frames=frames, min_visible=min_visible)
        images = replace(scores.counts, frames=len(range(0, frames, every)))
        return ScoredPeople(replace(scores, counts=images), by, notes_on(folder, by, truth, tracks))
    robot = read_table(folder / "robot.parquet", ROBOT, POSE)
    people = read_table(folder / "truth.parquet", TRUTH, PEOPLE)
    beliefs = read_table(folder / "tracks.parquet", TRACKS, BELIEFS)
    is_on_floor = is_on_floor_alone(beliefs)
    if is_on_floor:
        truth, tracks = as_squares(folder, people, beliefs, robot)
    scores = evaluate(
        truth,
        tracks,
        frames=frames,
        min_visible=min_visible,
        standing=places_of_people(people, robot),
        believed=places_of_tracks(beliefs),
    )
    if is_on_floor:
        return ScoredPeople(scores)
    return ScoredPeople(scores, by, notes_on(folder, by, truth, tracks))
