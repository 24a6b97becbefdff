"""How well webcams in the corners of a room tell where somebody is, against the exact truth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.studies.webcams.hat import hat_column
from peopleboy.scenarios.studies.webcams.triangulate import bearings, calibrate, triangulate
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.sim.world import World

Floats = NDArray[np.float64]

SCENE: Final = "corner_webcams"
KNOWN: Final = 12  # of the places where the person stands
SKEW_S: Final = 0.2
_STILL_M_S: Final = 0.05
_EARS: Final = slice(3, 5)  # of the 17 joints
_GUESS_OFF: Final = (0.2, 0.2, math.radians(5.0), math.radians(3.0))  # of a webcam that was put up by hand


@dataclass(frozen=True, slots=True, kw_only=True)
class WebcamErrors:
    """Mean distances [m] of the triangulated hat from where it is, the middle between the ears.

    Attributes:
        in_sample_m: at the known places, to which the webcams were fitted.
        new_m: standing at other places.
        walking_m: walking, all webcams at once.
        skewed_m: walking, the webcams one after the other within `SKEW_S`.
        bearing_deg: mean error [deg] of the bearing from the robot while walking, all at once.
        skewed_bearing_deg: the same with the webcams one after the other.
    """

    in_sample_m: float
    new_m: float
    walking_m: float
    skewed_m: float
    bearing_deg: float
    skewed_bearing_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class _Film:
    """What there is to triangulate: (T, C) columns [px], (T, 2) hats [m], (T,) whether they stand still."""

    columns: Floats
    hat_m: Floats
    is_still: NDArray[np.bool_]


def measure_webcams(seed: int) -> WebcamErrors:
    """Play the scene, calibrate the webcams at known places, and measure.

    Raises:
        BadInput: a webcam sees the hat too seldom.
    """
    scenario = load_scenario(SCENE)
    config = scenario.world(seed)
    cameras = [name for name in config.robot.cameras if name.startswith("webcam")]
    film = _shoot(config, cameras, round(scenario.duration_s * config.control_hz))
    width = config.robot.cameras[cameras[0]].camera.width
    places = _standing(film)
    columns = np.array([film.columns[place].mean(axis=0) for place in places])
    stood = np.array([film.hat_m[place].mean(axis=0) for place in places])
    guess = _true_webcams(config, cameras)
    guess += stream(seed, "webcams.guess").uniform(-1.0, 1.0, guess.shape) * _GUESS_OFF
    webcams = calibrate(columns[:KNOWN], stood[:KNOWN], guess, width)
    found = triangulate(bearings(columns, webcams, width), webcams)
    off = np.hypot(*(found - stood).T)

    walk = slice(places[-1].stop, None)
    robot = np.array(config.robot.at_m)
    walking, at_once = _errors(film.columns[walk], film.hat_m[walk], webcams, width, robot)
    late = _skew(film.columns, config.control_hz)
    skewed, in_turn = _errors(late[walk], film.hat_m[walk], webcams, width, robot)
    return WebcamErrors(
        in_sample_m=float(np.nanmean(off[:KNOWN])),
        new_m=float(np.nanmean(off[KNOWN:])),
        walking_m=walking,
        skewed_m=skewed,
        bearing_deg=at_once,
        skewed_bearing_deg=in_turn,
    )


def _shoot(config: WorldConfig, cameras: Sequence[str], frames: int) -> _Film:
    columns = np.full((frames, len(cameras)), np.nan)
    hat, speed = np.zeros((frames, 2)), np.zeros(frames)
    with World(config) as world:
        for frame in range(frames):
            images = world.observe().images
            found = [hat_column(images[camera]) for camera in cameras]
            columns[frame] = [math.nan if column is None else column for column in found]
            (person,) = world.truth().people
            hat[frame], speed[frame] = _hat_of(person), math.hypot(*person.velocity_m_s)
            world.step(0.0, 0.0)
    return _Film(columns, hat, speed < _STILL_M_S)


def _hat_of(person: PersonTruth) -> Floats:
    return np.asarray(person.joints_m[_EARS, :2].mean(axis=0))


def _standing(film: _Film) -> list[slice]:
    """Find the spans in which the person stands for a second or more, the middle of each."""
    edges = np.diff(np.concatenate([[0], film.is_still.astype(np.int8), [0]]))
    spans = zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True)
    return [slice(start + 4, end - 2) for start, end in spans if end - start >= 15 and end < len(film.hat_m)]


def _true_webcams(config: WorldConfig, cameras: Sequence[str]) -> Floats:
    """Give x, y [m], heading and angle of view [rad] of the webcams in the room, (C, 4)."""
    return np.array([_true_webcam(config, name) for name in cameras])


def _true_webcam(config: WorldConfig, name: str) -> tuple[float, float, float, float]:
    camera = flat_geometry(config.robot.cameras, name)
    (x, y), turn = config.robot.at_m, config.robot.heading_rad
    ahead, aside, _ = camera.position_m
    cosine, sine = math.cos(turn), math.sin(turn)
    view = 2.0 * math.atan(camera.width / 2.0 / camera.focal_px)
    return x + cosine * ahead - sine * aside, y + sine * ahead + cosine * aside, turn + camera.yaw_rad, view


def _skew(columns: Floats, rate_hz: int) -> Floats:
    """Let each webcam's columns (T, C) come later than those of the one before it, the last by `SKEW_S`."""
    late = columns.copy()
    for number in range(columns.shape[1]):
        frames = round(SKEW_S * rate_hz * number / (columns.shape[1] - 1))
        late[frames:, number] = columns[: len(columns) - frames, number]
    return late


def _errors(
    columns: Floats, hat_m: Floats, webcams: Floats, width: int, robot_m: Floats
) -> tuple[float, float]:
    """Give the mean error of the place [m], and of the bearing from the robot [deg]."""
    found = triangulate(bearings(columns, webcams, width), webcams)
    true, said = (np.arctan2(*(place - robot_m).T[::-1]) for place in (hat_m, found))
    turned = np.degrees(np.abs(np.arctan2(np.sin(said - true), np.cos(said - true))))
    return float(np.nanmean(np.hypot(*(found - hat_m).T))), float(np.nanmean(turned))
