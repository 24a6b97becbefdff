"""The external measurement in pictures: figures 2 and 3 of the 2003 paper."""

from __future__ import annotations

from typing import Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import World
from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.studies.reproductions.webcams.hat import hat_column
from peopleboy.studies.reproductions.webcams.measure import SCENE, true_webcams, webcam_names
from peopleboy.studies.reproductions.webcams.triangulate import HEADING, RANGE, X, Y

_AT_S: Final = 3.0
_STEP_M: Final = 0.05


def draw_webcam_images() -> Figure:
    """Draw what the four webcams see at one instant, and where the hat was found."""
    config = load_scenario(SCENE).world(0)
    names = webcam_names(config)
    with World(config) as world:
        for _ in range(round(_AT_S * config.control_hz)):
            world.step(0.0, 0.0)
        seen = world.observe().images
        images = {name: seen[name] for name in names}
    figure = canvas(4.4, 5.6)
    for axes, name in zip(figure.subplots(2, 2).flat, names, strict=True):
        axes.imshow(images[name])
        axes.set_axis_off()
        column = hat_column(images[name])
        label(axes, f"{name}: hat {'not seen whole' if column is None else f'at column {column:.1f}'}")
        if column is not None:
            axes.axvline(column, color="#d95f02", linewidth=1.0)
    return figure


def draw_fields_of_view() -> Figure:
    """Draw the floor plan with the webcams and the robot, shaded by how many webcams see a place."""
    scenario = load_scenario(SCENE)
    config = scenario.world(0)
    webcams = true_webcams(config, webcam_names(config))
    floor = scenario.plan.bounds()
    low_x, low_y, high_x, high_y = floor.min_x, floor.min_y, floor.max_x, floor.max_y
    x, y = np.meshgrid(np.arange(low_x, high_x, _STEP_M), np.arange(low_y, high_y, _STEP_M))
    seen = sum(
        np.abs(np.angle(np.exp(1j * (np.arctan2(y - one[Y], x - one[X]) - one[HEADING])))) < one[RANGE] / 2.0
        for one in webcams
    )
    figure = canvas(4.6)
    axes = figure.subplots()
    drawn = axes.pcolormesh(
        x, y, seen, cmap="Greens", vmin=-0.5, vmax=4.5, shading="nearest", rasterized=True
    )
    figure.colorbar(drawn, ax=axes, ticks=range(5), label="webcams that see it", shrink=0.8)
    axes.plot(webcams[:, X], webcams[:, Y], "o", color="#d95f02", markersize=9)
    axes.add_patch(Rectangle((low_x, low_y), high_x - low_x, high_y - low_y, fill=False, linewidth=1.5))
    axes.plot(*config.robot.at_m, "s", color="#d64541", markersize=10)
    axes.annotate("robot", config.robot.at_m, (10, -2), textcoords="offset points", fontsize=8, color="white")
    axes.set_aspect("equal")
    label(axes, "", "m", "m")
    return figure
