"""Pictures of people: with both shapes of bodies, with equipment, and at distances from 1.5 to 10 m."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, get_args

import numpy as np
from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.sim.cameras.sensors import Image
from peopleboy.sim.geometry.pinhole import CameraGeometry, Pinhole
from peopleboy.sim.people.motion.gait_styles import GAIT_STYLES
from peopleboy.sim.people.person_config import BodyShape
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig

SCALE = {"cmap": "gray", "vmin": 16.0, "vmax": 33.0}
WINDOW = slice(120, 470), slice(60, 580)  # rows and columns of 640 x 480
SCENARIO, TIME_S = "family_outing", 13.5
SQUARE, SQUARE_S = "busy_square", (6.0, 9.0)
PEOPLE, NEAREST_M, FARTHEST_M = 24, 1.5, 10.0
ROWS, COLUMNS, HIGH_M = 120, 60, 2.1  # of the picture of one person


def skins() -> Figure:
    """Draw the same people as capsules and as skins."""
    titles = ("capsules, colour", "skins, colour", "capsules, thermal", "skins, thermal")
    figure, axes = panels(titles, 6.4, columns=2)
    for at, bodies in enumerate(get_args(BodyShape)):
        images = _images(replace(load_scenario(SCENARIO).world(1), bodies=bodies), TIME_S)
        show(axes[at], images["colour"][WINDOW])
        show(axes[2 + at], images["thermal_c"][WINDOW], **SCALE)
    return figure


def equipment() -> Figure:
    """Draw people with equipment at two instants."""
    figure, axes = panels(("", "", "", ""), 6.4, columns=2)
    for at, time_s in enumerate(SQUARE_S):
        images = _images(load_scenario(SQUARE).world(0), time_s)
        show(axes[at], images["colour"][WINDOW[0]])
        show(axes[2 + at], images["thermal_c"][WINDOW[0]], **SCALE)
    return figure


def distances() -> Figure:
    """Draw people of all ages, in their gaits, at growing distances: thermal images above colour images."""
    away_m = np.geomspace(NEAREST_M, FARTHEST_M, PEOPLE)
    figure, axes = panels([""] * 4, 7.7, columns=1)
    shown = [_person(number, float(m)) for number, m in enumerate(away_m.tolist())]
    for half in range(2):
        own = shown[half * PEOPLE // 2 : (half + 1) * PEOPLE // 2]
        show(axes[2 * half], np.hstack([thermal for thermal, _ in own]), **SCALE)
        show(axes[2 * half + 1], np.hstack([colour for _, colour in own]))
    return figure


def _person(number: int, away_m: float) -> tuple[Image, Image]:
    """Return the thermal and the colour image (`ROWS`, `COLUMNS`) of a person, enlarged if it is small."""
    ages, gaits = ("adult", "child", "adult", "elder"), list(GAIT_STYLES)
    gait = gaits[number % len(gaits)]
    speed_m_s = 1.8 if gait == "running" else 1.0
    person = {
        "name": f"p{number}",
        "sex": ("male", "female")[number % 2],
        "age": ages[number % 4],
        "gait": gait,
        "path": [
            {"at_m": [0.8 + away_m, 0.3 * speed_m_s]},
            {"at_m": [0.8 + away_m, -3.0], "speed_m_s": speed_m_s},
        ],
    }
    data: dict[str, Any] = {
        "like": SQUARE, "name": f"person_{number}", "duration_s": 5.0, "people": [person], "things": [],
    }  # fmt: skip
    config = parse_scenario(data, source="picture", folder=LIBRARY).world(number)
    images = _images(config, 1.0)
    cameras = config.robot.cameras
    return (
        _cut_out(images["thermal_c"], cameras["thermal"].camera, away_m),
        _cut_out(images["colour"], cameras["colour"].camera, away_m),
    )


def _cut_out(image: Image, camera: CameraGeometry, away_m: float) -> Image:
    """Return the (`ROWS`, `COLUMNS`) window of 2.1 m x 1.05 m ahead of the robot, empty outside the image."""
    assert isinstance(camera, Pinhole)
    x, y, z = camera.position_m
    focal = image.shape[0] / 2.0 / math.tan(camera.vertical_fov_rad / 2.0)
    up = HIGH_M * (1.0 - (np.arange(ROWS) + 0.5) / ROWS) - 0.1
    left = HIGH_M * (COLUMNS / 2.0 - np.arange(COLUMNS) - 0.5) / ROWS
    v = np.rint(image.shape[0] / 2.0 - 0.5 - focal * (up - z) / (away_m - x)).astype(np.int64)
    u = np.rint(image.shape[1] / 2.0 - 0.5 - focal * (left - y) / (away_m - x)).astype(np.int64)
    low, high = image.min(), image.max()
    cut: Image = image[np.clip(v, 0, image.shape[0] - 1)[:, None], np.clip(u, 0, image.shape[1] - 1)]
    outside = (v < 0) | (v >= image.shape[0])
    cut[outside] = low if image.ndim == 2 else high
    return cut


def _images(config: WorldConfig, time_s: float) -> dict[str, Image]:
    """Return the images of an instant, 640 x 480 and without noise."""
    cameras = {
        name: config.robot.cameras[name].resized(640, 480).noisier(0.0) for name in ("thermal", "colour")
    }
    with SimulatedWorld(replace(config, robot=replace(config.robot, cameras=cameras))) as world:
        for _ in range(round(time_s * config.control_hz)):
            world.step(0.0, 0.0)
        return dict(world.observe().images)
