"""Picture of light in full detail."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from matplotlib.figure import Figure

from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.sensors import Image
from peopleboy.sim.shapes.materials import Detail
from peopleboy.sim.world import SimulatedWorld

SCALE = {"cmap": "gray", "vmin": 18.0, "vmax": 34.0}
WINDOW = slice(230, 470), slice(150, 420)  # rows and columns of 640 x 480


def light() -> Figure:
    """Draw people and their reflections on a polished floor, in plain and in full detail."""
    titles = ("plain, colour", "full, colour", "plain, thermal", "full, thermal")
    figure, axes = panels(titles, 2.7)
    for at, detail in enumerate(get_args(Detail)):
        images = _images("crossing_4", 4.0, detail)
        show(axes[at], images["colour"][WINDOW])
        show(axes[2 + at], images["thermal_c"][WINDOW], **SCALE)
    return figure


def _images(scenario: str, time_s: float, detail: Detail) -> dict[str, Image]:
    """Return the images of an instant, 640 x 480 and without noise, with a polished floor."""
    config = replace(load_scenario(scenario).world(0), detail=detail)
    cameras = {
        name: config.robot.cameras[name].resized(640, 480).noisier(0.0) for name in ("thermal", "colour")
    }
    fixtures = tuple(
        replace(one, part=replace(one.part, material=replace(one.part.material, shine=0.7)))
        if one.name == "floor" and one.part is not None
        else one
        for one in config.place.fixtures
    )
    config = replace(
        config,
        robot=replace(config.robot, cameras=cameras),
        place=replace(config.place, fixtures=fixtures),
    )
    with SimulatedWorld(config) as world:
        for _ in range(round(time_s * config.control_hz)):
            world.step(0.0, 0.0)
        return dict(world.observe().images)
