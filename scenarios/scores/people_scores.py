"""How well people were found in a run: in the image of a camera, and on the floor."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.tables import PLACE
from peopleboy.tracker.evaluation.boxes import Floats
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.floor import Places, floor_squares
from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.evaluation.uncounted import MIN_VISIBLE
from peopleboy.tracker.track import Status

_POSE = ["frame", "x_m", "y_m", "heading_rad"]
_PERSON = ["frame", "id", "x_m", "y_m", "is_counted", "visible_fraction", "whole_px"]
_TRACK = ["frame", "id", "confidence", "status", "left_px", *PLACE]


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
    poses = pq.read_table(folder / "robot.parquet", columns=_POSE)
    people = pq.read_table(folder / "truth.parquet", columns=_PERSON)
    said = pq.read_table(folder / "tracks.parquet", columns=_TRACK)
    said = said.filter(pa.array([status != Status.TENTATIVE for status in said["status"].to_pylist()]))
    standing, believed = _standing(people, poses), _believed(said)
    if len(believed.frame) and said["left_px"].null_count == len(said):
        in_view = people["whole_px"].to_numpy() > 0
        truth = TrueBoxes(
            frame=standing.frame[in_view],
            id=standing.id[in_view],
            box=floor_squares(standing.position_m[in_view]),
            counted=np.asarray(people["is_counted"].to_pylist(), np.bool_)[in_view],
            visible=people["visible_fraction"].to_numpy()[in_view],
        )
        has_place = said["place_x_m"].is_valid().to_numpy()
        tracks = TrackBoxes(
            frame=believed.frame,
            id=believed.id,
            box=floor_squares(believed.position_m),
            confidence=said["confidence"].to_numpy()[has_place],
        )
    return evaluate(
        truth, tracks, frames=frames, min_visible=min_visible, standing=standing, believed=believed
    )


def score_camera(folder: Path, camera: str, frames: int, min_visible: float = MIN_VISIBLE) -> Scores:
    """Score the boxes that the tracker of a run gave in the image of a further camera.

    Raises:
        BadInput: there are none.
    """
    truth, tracks = folder / "truth" / f"{camera}.gt.txt", folder / "tracks" / f"{camera}.txt"
    for path in (truth, tracks):
        if not path.is_file():
            raise BadInput(f"{path}: there is no such file; no boxes were given in camera {camera!r}")
    return evaluate(read_truth(truth), read_tracks(tracks), frames=frames, min_visible=min_visible)


def _standing(people: pa.Table, poses: pa.Table) -> Places:
    """Tell where people stand in the robot's frame."""
    frame, row = people["frame"].to_numpy(), _columns(poses, _POSE)
    if not np.isin(frame, row[:, 0]).all():
        raise BadInput("truth.parquet: has frames that robot.parquet has not; run the scenario again")
    x, y, heading = row[np.searchsorted(row[:, 0], frame), 1:].T
    dx, dy = people["x_m"].to_numpy() - x, people["y_m"].to_numpy() - y
    cosine, sine = np.cos(heading), np.sin(heading)
    seen = np.stack([dx * cosine + dy * sine, dy * cosine - dx * sine], axis=-1)
    return Places(frame=frame, id=people["id"].to_numpy(), position_m=seen)


def _believed(said: pa.Table) -> Places:
    """Tell where tracks say that people stand; those that do not say it are left out."""
    placed = said.filter(said["place_x_m"].is_valid())
    columns = _columns(placed, PLACE)
    return Places(
        frame=placed["frame"].to_numpy(),
        id=placed["id"].to_numpy(),
        position_m=columns[:, :2],
        covariance_m2=columns[:, 2:],
    )


def _columns(table: pa.Table, names: list[str] | tuple[str, ...]) -> Floats:
    """Give columns as one array (N, K)."""
    return np.stack([table[name].to_numpy().astype(np.float64) for name in names], axis=-1)
