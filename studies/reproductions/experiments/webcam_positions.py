"""Triangulate people by webcams in the corners of a room (2003 paper, section 4), with ground truth."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.world_config import WorldConfig
from peopleboy.studies.reproductions.image_errors import ErrorSummary
from peopleboy.studies.training.distance import panoramas
from peopleboy.tracker.frame import PANORAMA
from peopleboy.tracker.reproductions.panoramic.depth_cues import (
    EMPTY_IMAGES,
    Background,
    learn_background,
    measure,
)
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicConfig

LEAST_ANGLE_RAD: Final = math.radians(
    10.0
)  # minimum between two lines of sight; flatter intersections are ill-conditioned
X, Y, HEADING, RANGE = range(4)
"""Columns of the webcams' parameters: x, y [m], heading and angle of view [rad], counter-clockwise."""


def bearings(columns: "Floats", webcams: "Floats", width: int) -> "Floats":
    """Convert hats' columns (..., C) [px] to angles (..., C) [rad] in the room; NaN stays NaN.

    Args:
        columns: one per webcam.
        webcams: (C, 4) parameters.
        width: width of the images [px].
    """
    focal = width / 2.0 / np.tan(webcams[:, RANGE] / 2.0)
    return np.asarray(webcams[:, HEADING] + np.arctan2((width - 1) / 2.0 - columns, focal))


def triangulate(angles: "Floats", webcams: "Floats") -> "Floats":
    """Triangulate positions (T, 2) [m] from angles (T, C) [rad]; NaN with fewer than two webcams.

    Every pair of webcams that sees the hat gives a point. The paper does not state how points are combined;
    here it is their mean, weighted by the squared sine of the angle between their lines.
    """
    total, weight = np.zeros((len(angles), 2)), np.zeros(len(angles))
    for a, b in combinations(range(len(webcams)), 2):
        one, other = angles[:, a], angles[:, b]
        sine = np.sin(other - one)
        between = webcams[b, :2] - webcams[a, :2]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (between[0] * np.sin(other) - between[1] * np.cos(other)) / sine
        point = webcams[a, :2] + along[:, None] * np.stack([np.cos(one), np.sin(one)], axis=1)
        counts = np.where(np.abs(sine) >= math.sin(LEAST_ANGLE_RAD), sine**2, 0.0)
        is_known = np.isfinite(point).all(axis=1) & (counts > 0.0)
        total[is_known] += counts[is_known, None] * point[is_known]
        weight[is_known] += counts[is_known]
    with np.errstate(invalid="ignore"):
        return np.asarray(total / np.where(weight > 0.0, weight, np.nan)[:, None])


def calibrate(columns: "Floats", known_m: "Floats", guess: "Floats", width: int) -> "Floats":
    """Fit the 16 parameters of four webcams, (C, 4), to hats' columns (T, C) at known positions (T, 2) [m].

    Source: 2003 paper, section 4, which minimises the mean distance of the triangulated positions from the
    known ones; here it is the mean squared distance.

    Raises:
        BadInput: a webcam never sees the hat, or there are fewer known positions than the fit needs.
    """
    for number, seen in enumerate(np.isfinite(columns).sum(axis=0)):
        if seen < len(guess[0]):
            raise BadInput(f"webcam {number + 1}: the hat is visible at {seen} known positions; 4 are needed")

    def residuals(flat: Floats) -> Floats:
        webcams = flat.reshape(guess.shape)
        found = triangulate(bearings(columns, webcams, width), webcams)
        return np.nan_to_num(found - known_m, nan=1.0).ravel()

    return np.asarray(least_squares(residuals, guess.ravel(), x_scale=0.1).x.reshape(guess.shape))


HUES: Final = (45, 75)  # of green, in OpenCV's half degrees
LEAST_SATURATION: Final = 110
LEAST_VALUE: Final = 40
LEAST_PX: Final = 12


def hat_column(image: NDArray[np.uint8]) -> float | None:
    """Return the middle column [px] of the hat in an (H, W, 3) sRGB image; None if not fully visible."""
    hsv = cv2.cvtColor(image, cv2.COLOR_RGB2HSV)
    low = np.array([HUES[0], LEAST_SATURATION, LEAST_VALUE])
    mask = cv2.inRange(hsv, low, np.array([HUES[1], 255, 255]))
    count, _, stats, centres = cv2.connectedComponentsWithStats(mask)
    if count < 2:
        return None
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    left, _, width, _, area = stats[largest].tolist()
    if area < LEAST_PX or left == 0 or left + width == image.shape[1]:
        return None
    return float(centres[largest, 0])


Floats = NDArray[np.float64]

SCENE: Final = "corner_webcams"
KNOWN: Final = 12  # of the places where the person stands
SKEW_S: Final = 0.2
RATE_HZ: Final = 3  # of the panorama
_STILL_M_S: Final = 0.05
_EARS: Final = slice(3, 5)  # of the 17 joints
_GUESS_OFF: Final = (0.2, 0.2, math.radians(5.0), math.radians(3.0))  # of a manually mounted webcam


def measure_webcams(seed: int) -> dict[str, Any]:
    """Play the scene, calibrate the webcams at known positions, and measure.

    Returns:
        Plain data: mean distances [m] of the triangulated hat from its true position, the middle between the
        ears, while the person stands at the known positions, "in_sample_m", or at others, "new_m"; and while
        the person walks, with simultaneous images, "walking_m", or images one after the other within
        `SKEW_S`, "skewed_m". For these two also "bearing_deg" and "skewed_bearing_deg", mean errors [deg] of
        the bearing from the robot; and as "panorama_...", an `ErrorSummary` of the bearing [deg] of the
        silhouette in the panorama, as measured by the paper's tracker, against ground truth and against
        webcams "at_once", "skewed", or "late" by `SKEW_S`.

    Raises:
        BadInput: a webcam sees the hat too seldom; checked before the scene is played if possible.
    """
    scenario = load_scenario(SCENE)
    config = with_panorama(scenario.world(seed))
    cameras = webcam_names(config)
    true = true_webcams(config, cameras)
    check_views(true, np.array([point.at_m for point in config.people[0].path[:KNOWN]]))
    in_images, hat_m, is_still, bearing = _shoot(
        config, cameras, round(scenario.duration_s * config.control_hz)
    )
    width = config.robot.cameras[cameras[0]].camera.width
    places = _standing(is_still)
    columns = np.array([in_images[place].mean(axis=0) for place in places])
    stood = np.array([hat_m[place].mean(axis=0) for place in places])
    guess = true + stream(seed, "webcams.guess").uniform(-1.0, 1.0, true.shape) * _GUESS_OFF
    webcams = calibrate(columns[:KNOWN], stood[:KNOWN], guess, width)
    off = np.hypot(*(triangulate(bearings(columns, webcams, width), webcams) - stood).T)

    walk, robot = slice(places[-1].stop, None), np.array(config.robot.at_m)
    true_m, seen_rad = hat_m[walk], bearing[walk]
    count, late = len(cameras), round(SKEW_S * config.control_hz)
    delays = {
        "at_once": [0] * count,
        "skewed": [round(SKEW_S * config.control_hz * number / (count - 1)) for number in range(count)],
        "late": [late] * count,
    }
    walking = {
        name: triangulate(bearings(_delayed(in_images, each)[walk], webcams, width), webcams)
        for name, each in delays.items()
    }

    found = {"in_sample_m": float(np.nanmean(off[:KNOWN])), "new_m": float(np.nanmean(off[KNOWN:]))}
    for name, metres, degrees in (
        ("at_once", "walking_m", "bearing_deg"),
        ("skewed", "skewed_m", "skewed_bearing_deg"),
    ):
        errors_deg = _between(_bearing(walking[name], robot), _bearing(true_m, robot))
        found[metres] = float(np.nanmean(np.hypot(*(walking[name] - true_m).T)))
        found[degrees] = float(np.nanmean(errors_deg))
    against = {"truth": true_m} | walking
    return found | {f"panorama_{name}": _summary(seen_rad, one, robot) for name, one in against.items()}


def with_panorama(config: WorldConfig) -> WorldConfig:
    """Return the scenario with the panoramic camera, at the paper's rate."""
    cameras = {**config.robot.cameras, PANORAMA: PanoramaConfig(rate_hz=RATE_HZ)}
    return replace(config, robot=replace(config.robot, cameras=cameras))


def webcam_names(config: WorldConfig) -> list[str]:
    """Return the names of the webcams of the scene."""
    return [name for name in config.robot.cameras if name.startswith("webcam")]


def check_views(webcams: Floats, places_m: Floats) -> None:
    """Check that webcams (C, 4) cover the known positions (T, 2) [m].

    Raises:
        BadInput: one has fewer of them in its field of view than its four parameters need.
    """
    for number, (x, y, heading, view) in enumerate(webcams.tolist(), 1):
        off = np.arctan2(places_m[:, 1] - y, places_m[:, 0] - x) - heading
        seen = np.count_nonzero(np.abs(np.angle(np.exp(1j * off))) < view / 2.0)
        if seen < webcams.shape[1]:
            raise BadInput(f"webcam {number}: {seen} of the known positions are in view; 4 are needed")


def _shoot(
    config: WorldConfig, cameras: Sequence[str], frames: int
) -> tuple[Floats, Floats, NDArray[np.bool_], Floats]:
    """Play the scene.

    Returns:
        (T, C) columns [px] of the hat in the webcams; (T, 2) its position [m]; (T,) whether the person
        stands; and (T,) the bearing in the room [rad] of the silhouette in the panorama, NaN without one.
    """
    background = _empty_room(config)
    columns = np.full((frames, len(cameras)), np.nan)
    hat, speed, seen = np.zeros((frames, 2)), np.zeros(frames), np.full(frames, np.nan)
    from peopleboy.sim.world import SimulatedWorld  # here, as stored results can be read without PyBullet

    with SimulatedWorld(config) as world:
        for frame in range(frames):
            images = world.observe().images
            found = [hat_column(images[camera]) for camera in cameras]
            columns[frame] = [math.nan if column is None else column for column in found]
            if PANORAMA in images:
                seen[frame] = _seen(images[PANORAMA], background, config.robot.heading_rad)
            (person,) = world.truth().people
            hat[frame] = person.joints_m[_EARS, :2].mean(axis=0)
            speed[frame] = math.hypot(*person.velocity_m_s)
            world.step(0.0, 0.0)
    return columns, hat, speed < _STILL_M_S, seen


def _empty_room(config: WorldConfig) -> Background:
    """Learn the background from the scene without the person."""
    duration_s = EMPTY_IMAGES / RATE_HZ
    return learn_background([image for image, _ in panoramas(replace(config, people=()), duration_s)])


def _seen(image: NDArray[np.uint8], background: Background, heading_rad: float) -> float:
    """Return the bearing of the silhouette in the room [rad]; NaN without one."""
    figure = measure(background.silhouette(image), PanoramicConfig().least_px)
    return math.nan if figure is None else heading_rad + figure.bearing_rad


def _standing(is_still: NDArray[np.bool_]) -> list[slice]:
    """Return the middle of each span in which the person stands for a second or more."""
    edges = np.diff(np.concatenate([[0], is_still.astype(np.int8), [0]]))
    spans = zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    return [slice(start + 4, end - 2) for start, end in spans if end - start >= 15 and end < len(is_still)]


def true_webcams(config: WorldConfig, cameras: Sequence[str]) -> Floats:
    """Return x, y [m], heading and angle of view [rad] of the webcams in the room, (C, 4)."""
    robot = Pose2(*config.robot.at_m, config.robot.heading_rad)
    rows = []
    for camera in (flat_geometry(config.robot.cameras, name) for name in cameras):
        place = robot.transform_point(camera.position_m[:2])
        view = 2.0 * math.atan(camera.width / 2.0 / camera.focal_px)
        rows.append((*place, robot.heading + camera.yaw_rad, view))
    return np.array(rows)


def _delayed(columns: Floats, frames: Sequence[int]) -> Floats:
    """Delay each webcam's columns (T, C) by a number of frames."""
    late = columns.copy()
    for number, count in enumerate(frames):
        late[count:, number] = columns[: len(columns) - count, number]
    return late


def _bearing(places_m: Floats, robot_m: Floats) -> Floats:
    """Return the bearings (T,) [rad] of positions (T, 2) [m] from the robot, in the room."""
    return np.asarray(np.arctan2(*(places_m - robot_m).T[::-1]), np.float64)


def _between(one_rad: Floats, other_rad: Floats) -> Floats:
    """Return the angles (T,) between directions, in 0..180 [deg]."""
    return np.asarray(np.degrees(np.abs(np.angle(np.exp(1j * (one_rad - other_rad))))), np.float64)


def _summary(seen_rad: Floats, places_m: Floats, robot_m: Floats) -> ErrorSummary:
    """Summarise errors [deg] at times with a bearing of both the panorama and the other measurement."""
    off = _between(seen_rad, _bearing(places_m, robot_m))
    return ErrorSummary.of(off[np.isfinite(off)])
