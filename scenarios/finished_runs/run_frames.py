"""Read the frames of a finished run from its folder, as input for a tracker or a scene model."""

import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.scenarios.run_folder.run_tables import odometry_pose
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.cameras.kinds import image_folders
from peopleboy.tracker.frame import DEPTH, DEPTH_AMPLITUDE, DEPTH_COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.scene_model.scene import Change, Happening

IMAGES: Final = (DEPTH, DEPTH_COLOUR, DEPTH_AMPLITUDE, THERMAL)
"""Cameras that the scene model uses, as far as a run has them."""


def check_frames(run: FinishedRun) -> None:
    """Refuse a run without images of a depth camera.

    Raises:
        BadInput: the run has none.
    """
    if DEPTH not in run.robot.cameras:
        known = ", ".join(run.robot.cameras)
        raise BadInput(
            f"{run.folder}: the robot has no camera {DEPTH!r}, only {known}; add one to the scenario"
        )
    if not (run.folder / DEPTH / image_file(1)).is_file():
        raise BadInput(f"{run.folder}: has no images; run the scenario with --frames")


def run_frames(run: FinishedRun) -> Iterator[Frame]:
    """Yield the frames at which the depth camera took an image, with the odometry since the last one.

    Raises:
        BadInput: an image or the odometry is missing or damaged.
    """
    check_frames(run)
    calibrations = calibrations_of(run.robot.cameras)
    folders = {image: folder for folder, image, _ in image_folders(run.robot.cameras) if image in IMAGES}
    before: Pose2 | None = None
    for row in run.files().robot.to_pylist():
        images = _read(run.folder, folders, row["frame"])
        if DEPTH not in images:
            continue
        now = odometry_pose(row)
        odometry = None if before is None else Odometry.between(before, now)
        yield Frame(images=images, calibrations=calibrations, time_s=row["time_s"], odometry=odometry)
        before = now


def _read(folder: Path, folders: Mapping[str, str], frame: int) -> dict[str, NDArray[Any]]:
    """Read the images of a frame; cameras that took no image are left out."""
    paths = {name: folder / place / image_file(frame) for name, place in folders.items()}
    return {name: _image(path) for name, path in paths.items() if path.is_file()}


def _image(path: Path) -> NDArray[Any]:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise BadInput(f"{path}: cannot be read as an image; run the scenario again")
    return np.ascontiguousarray(image[..., ::-1] if image.ndim == 3 else image)


# Positions of people: what disappears at such a position was part of a person, or held by one.

BODY_M: Final = 0.3
"""[m] radius around a person on the floor within which no separate object is assumed."""

BEFORE_S: Final = 2.0
"""[s] before a disappearance, in which a person may have stood at the position."""

REPORTED_S: Final = 60.0
"""[s] maximum delay between a disappearance and its report; it may be occluded for long."""


class PersonPositions:
    """Store the positions of people, as long as a disappearance may be reported there."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, tuple[tuple[float, float], ...]]] = deque()

    def look(self, time_s: float, places_m: Iterable[tuple[float, float]]) -> None:
        """Add the positions of people at an instant, (x, y) in the frame of the robot's start pose."""
        self._places.append((time_s, tuple(places_m)))
        while self._places[0][0] < time_s - REPORTED_S - BEFORE_S:
            self._places.popleft()

    def explain(self, happening: Happening) -> bool:
        """Return whether a disappearance reported now was at a position where a person stood."""
        if happening.change is not Change.VANISHED or happening.from_m is None:
            return False
        place = happening.from_m[:2]
        return any(
            math.dist(place, body) < BODY_M
            for time_s, bodies in self._places
            if happening.time_s - BEFORE_S <= time_s <= happening.time_s
            for body in bodies
        )
