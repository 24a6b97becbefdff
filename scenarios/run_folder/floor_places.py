"""Read where on the floor people stood in a run, and where its tracker placed them: in the robot's frame."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.run_files import read_table
from peopleboy.scenarios.run_folder.run_tables import PLACE, TRUTH
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.floor import Places
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.track import Status

POSE: Final = ("frame", "x_m", "y_m", "heading_rad")
VIEW: Final = ("frame", "id", "visible_fraction", "is_counted")
PEOPLE: Final = (*VIEW, "x_m", "y_m")
BELIEFS: Final = ("frame", "id", "confidence", "status", "left_px", *PLACE)
"""The columns of robot.parquet, truth.parquet and tracks.parquet that are needed here."""


def places_of_people(people: pa.Table, robot: pa.Table) -> Places:
    """Return where people stood.

    Raises:
        BadInput: the robot's place is not known in every frame.
    """
    frame, poses = people["frame"].to_numpy(), _columns(robot, POSE)
    if not np.isin(frame, poses[:, 0]).all():
        raise BadInput("truth.parquet: has frames that robot.parquet has not; run the scenario again")
    x, y, heading = poses[np.searchsorted(poses[:, 0], frame), 1:].T
    dx, dy = people["x_m"].to_numpy() - x, people["y_m"].to_numpy() - y
    cosine, sine = np.cos(heading), np.sin(heading)
    seen = np.stack([dx * cosine + dy * sine, dy * cosine - dx * sine], axis=-1)
    return Places(frame=frame, id=people["id"].to_numpy(), position_m=seen)


def places_of_tracks(beliefs: pa.Table) -> Places:
    """Return where confirmed tracks are said to stand; those of which it is not said are left out."""
    placed = _placed(beliefs)
    columns = _columns(placed, PLACE)
    return Places(
        frame=placed["frame"].to_numpy(),
        id=placed["id"].to_numpy(),
        position_m=columns[:, :2],
        covariance_m2=columns[:, 2:],
    )


def is_on_floor_alone(beliefs: pa.Table) -> bool:
    """Return whether a tracker gave places of people, but of nobody a box in the thermal image."""
    return bool(len(beliefs)) and beliefs["left_px"].null_count == len(beliefs) and len(_placed(beliefs)) > 0


def as_squares(
    folder: Path, people: pa.Table, beliefs: pa.Table, robot: pa.Table
) -> tuple[TrueBoxes, TrackBoxes]:
    """Put squares on the floor [m] for the boxes of everybody who is there, and of confirmed tracks.

    Who counts, and how much of a person is visible, is taken from the cameras in which the tracker gave
    boxes, or else by the thermal one; who is in no image is nobody to find, and no false alarm either.

    Args:
        folder: of the run.
        people: its truth.parquet, the columns `PEOPLE` among others.
        beliefs: its tracks.parquet.
        robot: its robot.parquet.
    """
    standing, believed = places_of_people(people, robot), places_of_tracks(beliefs)
    visible, counted = _viewed(folder, people)
    confidence = _placed(beliefs)["confidence"].to_numpy()
    return standing.as_targets(counted, visible), believed.as_candidates(confidence)


def _viewed(folder: Path, people: pa.Table) -> tuple[Floats, NDArray[np.bool_]]:
    """Tell how much of people is visible (N,), in the image that shows most, and whether any counts them."""
    boxed = [folder / "truth" / f"{path.stem}.parquet" for path in sorted((folder / "tracks").glob("*.txt"))]
    views = [read_table(path, TRUTH, VIEW) for path in boxed] or [people]
    most: dict[tuple[int, int], float] = defaultdict(float)
    counted: set[tuple[int, int]] = set()
    for view in views:
        for frame, number, visible, counts in zip(*(view[name].to_pylist() for name in VIEW), strict=True):
            most[frame, number] = max(most[frame, number], visible)
            counted |= {(frame, number)} if counts else set()
    rows = list(zip(people["frame"].to_pylist(), people["id"].to_pylist(), strict=True))
    return np.array([most[row] for row in rows], np.float64), np.array([row in counted for row in rows], bool)


def _placed(beliefs: pa.Table) -> pa.Table:
    is_sure = np.array([status != Status.TENTATIVE for status in beliefs["status"].to_pylist()], np.bool_)
    has_place = beliefs["place_x_m"].is_valid().to_numpy()
    return beliefs.filter(pa.array(is_sure & has_place))


def _columns(table: pa.Table, names: Sequence[str]) -> Floats:
    """Return columns as one array (N, K)."""
    return np.stack([table[name].to_numpy().astype(np.float64) for name in names], axis=-1)
