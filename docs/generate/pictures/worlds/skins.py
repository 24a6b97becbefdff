"""Picture of people with both shapes of bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.sensors import Image
from peopleboy.sim.people.person_config import BodyShape
from peopleboy.sim.world import SimulatedWorld

SCALE = {"cmap": "gray", "vmin": 16.0, "vmax": 33.0}
WINDOW = slice(120, 470), slice(60, 580)  # rows and columns of 640 x 480
SCENARIO, TIME_S = "family_outing", 13.5


def skins() -> Figure:
    """Draw the same people as capsules and as skins."""
    titles = ("capsules, colour", "skins, colour", "capsules, thermal", "skins, thermal")
    figure, axes = panels(titles, 6.4, columns=2)
    for at, bodies in enumerate(get_args(BodyShape)):
        images = _images(bodies)
        show(axes[at], images["colour"][WINDOW])
        show(axes[2 + at], images["thermal_c"][WINDOW], **SCALE)
    return figure


def _images(bodies: BodyShape) -> dict[str, Image]:
    """Return the images of an instant, 640 x 480 and without noise."""
    config = replace(load_scenario(SCENARIO).world(1), bodies=bodies)
    cameras = {
        name: config.robot.cameras[name].resized(640, 480).noisier(0.0) for name in ("thermal", "colour")
    }
    with SimulatedWorld(replace(config, robot=replace(config.robot, cameras=cameras))) as world:
        for _ in range(round(TIME_S * config.control_hz)):
            world.step(0.0, 0.0)
        return dict(world.observe().images)
