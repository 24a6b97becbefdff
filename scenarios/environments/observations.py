"""What a controller in an environment is told: images, tracks, or the truth in the form of tracks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.loop.thermal_box import thermal_box
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.image_free_truth import ImageFreeTruth
from peopleboy.tracker.boxes import Box, image_shares
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track

Arrays = dict[str, NDArray[Any]]
Row = tuple[float, ...]

KINDS: Final = ("pixels", "tracks", "truth")
MOST_TRACKS: Final = 5
COLUMNS: Final = ("id", "x", "height", "top", "bottom", "confidence", "is_visible")
"""The seven numbers of each of the five people in `tracks`, the tallest and so nearest first.

id is 1 or more and stays with a person; a row of zeros is nobody. x is in half image widths, -1 at the left
border, +1 at the right one; height, top and bottom are in image heights from the top; confidence is 0..1;
is_visible is 0 while a person is wholly hidden.
"""

_LOWEST: Final = (0.0, -10.0, 0.0, -10.0, -10.0, 0.0, 0.0)
_HIGHEST: Final = (1e6, 10.0, 10.0, 10.0, 10.0, 1.0, 1.0)
_SONARS: Final = 16
_FARTHEST_M: Final = 1e4
_FASTEST: Final = 10.0


def observation_space(kind: str, robot: RobotConfig, shown: Sequence[str]) -> spaces.Space[Arrays]:
    """Give the space of one of `KINDS`.

    `sonar` is (16,) [m], counted from the left to the front and round; `odometry` is (6,): x, y [m] from the
    start in its frame, cosine and sine of the heading since the start, forward speed [m/s], turn rate
    [rad/s]. `pixels` has the newest image of each camera that is `shown` beside them by its name, (H, W, 1)
    or (H, W, 3) uint8, such as `thermal` and `colour`, or of a depth camera (H, W, 1) uint16 [mm]; `tracks`
    and `truth` have `tracks` (35,), five rows of `COLUMNS`.
    """
    sonar = robot.sonar
    odometry = np.array([_FARTHEST_M, _FARTHEST_M, 1.0, 1.0, _FASTEST, _FASTEST], np.float32)
    found: dict[str, spaces.Space[Any]] = {
        "sonar": spaces.Box(sonar.nearest_m, sonar.farthest_m, (_SONARS,), np.float32),
        "odometry": spaces.Box(-odometry, odometry, dtype=np.float32),
    }
    if kind == "pixels":
        for name in shown:
            camera = robot.cameras[name]
            dtype = kind_of(camera).dtype
            found[name] = spaces.Box(0, int(np.iinfo(dtype).max), _shape(camera), dtype)
    else:
        lowest, highest = (np.tile(np.array(row, np.float32), MOST_TRACKS) for row in (_LOWEST, _HIGHEST))
        found["tracks"] = spaces.Box(lowest, highest, dtype=np.float32)
    return spaces.Dict(found)  # type: ignore[return-value]  # typed there as if samples were spaces


def feel(senses: Senses, start: Planar) -> Arrays:
    """Give what every observation has: sonar and odometry."""
    here = senses.odometry
    turned = here.heading - start.heading
    cos, sin = math.cos(start.heading), math.sin(start.heading)
    dx, dy = here.x - start.x, here.y - start.y
    left, right = senses.wheel_speeds_m_s
    odometry = (
        cos * dx + sin * dy, cos * dy - sin * dx, math.cos(turned), math.sin(turned),
        (left + right) / 2.0, (right - left) / WHEEL_DISTANCE_M,
    )  # fmt: skip
    return {"sonar": senses.sonar_m.astype(np.float32), "odometry": np.array(odometry, np.float32)}


def see_images(observation: Observation, robot: RobotConfig, shown: Sequence[str]) -> Arrays:
    """Give the images of `pixels`, of the cameras that are `shown` and have a new one."""
    images = observation.images
    return {name: images[name].reshape(_shape(robot.cameras[name])) for name in shown if name in images}


def see_tracks(tracks: Iterable[Track], robot: RobotConfig) -> Arrays:
    """Give what the tracker is sure of."""
    thermal = calibrations_of(robot.cameras)[THERMAL]
    return _table(
        _row(track.id, box, track.confidence, track.status is not Status.TOTALLY_OCCLUDED, robot)
        for track in tracks
        if track.status is not Status.TENTATIVE and (box := thermal_box(track, thermal)) is not None
    )


def see_truth(scene: ImageFreeTruth, robot: RobotConfig) -> Arrays:
    """Give what a perfect tracker would say: everybody within the image, hidden or not."""
    rows = (
        _row(person.id, person.box, 1.0, person.is_seen, robot)
        for person in scene.people
        if person.box is not None
    )
    return _table(row for row in rows if abs(row[1]) <= 1.0)  # whose middle lies between the borders


def _shape(camera: CameraConfig) -> tuple[int, int, int]:
    return camera.camera.height, camera.camera.width, kind_of(camera).channels


def _row(number: int, box: Box, confidence: float, visible: bool, robot: RobotConfig) -> Row:
    camera = robot.cameras["thermal"].camera
    return float(number), *image_shares(box, camera.width, camera.height), confidence, float(visible)


def _table(rows: Iterable[Row]) -> Arrays:
    """Put the tallest first, and nobody into the rest."""
    tallest = sorted(rows, key=lambda row: -row[2])[:MOST_TRACKS]
    numbers = [
        min(max(number, low), high)
        for row in tallest
        for number, low, high in zip(row, _LOWEST, _HIGHEST, strict=True)
    ]
    numbers += [0.0] * (MOST_TRACKS * len(COLUMNS) - len(numbers))
    return {"tracks": np.array(numbers, np.float32)}
