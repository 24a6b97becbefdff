"""One instant of a run: `python -m docs.generate.pictures.front.overview` draws docs/overview.png."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle, Wedge
from numpy.typing import NDArray

from docs.generate.pictures.moments import ticks
from docs.generate.pictures.paper import panels, show
from peopleboy.scenarios.drawing.overlay import draw_tracks, enlarge, show_thermal
from peopleboy.scenarios.drawing.palette import ROBOT, Rgb, person_colour
from peopleboy.scenarios.drawing.plan_sheet import Labels, draw_floor, draw_things, draw_walls
from peopleboy.scenarios.files.library import LIBRARY
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.truth.truth import BORDER, PersonTruth, Truth
from peopleboy.tracker.trackers import DEFAULT_TRACKER

PATH = Path(__file__).parents[3] / "overview.png"
SEED, FRAME = 0, 41
SCALE = 3
LEAST_SHARE = 0.02  # smallest occluded fraction that gets an arrow
LABEL_M = 0.4  # beyond the far wall, so that labels near it are not clipped
NIGHT: Rgb = (24, 26, 32)
TITLES = (
    "thermal image with tracks",
    "colour image, from a camera 6 cm away",
    "ground truth: body parts, boxes, visible fraction",
    "ground truth on the floor: who occludes whom, and how much",
)


def crossing() -> Scenario:
    """Return a crossing of four people in front of a standing robot, in full detail."""
    data = {
        "name": "crossing",
        "like": "crossing_4",
        "detail": "full",
        "robot": {"at_m": [0.6, 0.0], "cameras": {"thermal": {"kind": "thermal", "preset": "uncooled"}}},
    }
    return parse_scenario(data, source="crossing", folder=LIBRARY)


def overview() -> Figure:
    """Draw one instant of a crossing of four people."""
    *_, (_, tick) = ticks(crossing(), SEED, FRAME, DEFAULT_TRACKER)
    figure, (thermal, colour, truth, plan) = panels(TITLES, 8.7, columns=2)
    show(
        thermal,
        draw_tracks(
            enlarge(show_thermal(tick.observation.images["thermal_scene"]), SCALE),
            tick.tracks,
            SCALE,
            tick.explanation,
        ),
    )
    show(colour, tick.observation.images["colour"])
    draw_truth(truth, tick.truth)
    draw_plan(plan, crossing(), tick)
    return figure


def draw_truth(axes: Axes, truth: Truth) -> None:
    """Draw masks by body part, boxes, and the visible fraction of each person."""
    show(axes, _bodies(truth))
    height, width = truth.instance.shape
    axes.set_xlim(-0.5, width - 0.5)
    axes.set_ylim(height - 0.5, -0.5)
    for row, person in enumerate(truth.people):
        colour = _shade(person)
        text = f"{person.name}: {person.visible_fraction:.0%} visible"
        axes.text(6, 14 + 13 * row, text, color=colour, fontsize=9, va="center")
        if person.box is not None:
            left, top, box_width, box_height = person.box
            box = Rectangle((left, top), box_width, box_height, fill=False, ec=colour, ls=(0, (4, 2)), lw=1.3)
            axes.add_patch(box)


def _bodies(truth: Truth) -> NDArray[np.uint8]:
    """Paint the visible pixels of all people (H, W, 3), one shade for each body part."""
    picture = np.empty((*truth.instance.shape, 3), np.uint8)
    picture[:] = NIGHT
    shades = 0.55 + 0.45 * (truth.body_part * 5 % 7) / 6.0
    for person in truth.people:
        mask = truth.instance == person.id
        picture[mask] = (shades[mask, None] * np.array(person_colour(person.id))).astype(np.uint8)
    return picture


def draw_plan(axes: Axes, scenario: Scenario, tick: Tick) -> None:
    """Draw the place from above, the field of view, people, and arrows from occluder to occluded."""
    min_x, min_y, max_x, max_y = scenario.place.bounds
    max_x += LABEL_M
    axes.set_xlim(min_x, max_x)
    # The aspect ratio of the images in the other panels.
    axes.set_ylim(*((min_y + max_y) / 2.0 + np.array((-0.375, 0.375)) * (max_x - min_x)))
    axes.set_aspect("equal")
    labels = Labels(axes)
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_things(axes, labels, scenario.place)
    robot, camera = tick.truth.robot, tick.truth.camera
    assert isinstance(camera, Pinhole)
    half = math.degrees(math.atan(camera.width / 2.0 / camera.focal_px))
    ahead, tone = math.degrees(robot.heading), np.array(ROBOT) / 255.0
    axes.add_patch(Wedge((robot.x, robot.y), 12.0, ahead - half, ahead + half, fc=(*tone, 0.08), zorder=1))
    axes.add_patch(Circle((robot.x, robot.y), RADIUS_M, fc=tone, ec="0.2", zorder=5))
    axes.text(robot.x, robot.y - 0.35, "robot", fontsize=9, ha="center", va="top")
    for person in tick.truth.people:
        x, y = person.position_m
        axes.add_patch(Circle((x, y), 0.22, fc=_shade(person), ec="0.2", zorder=5))
        axes.text(x, y - 0.3, person.name, fontsize=9, ha="center", va="top", zorder=7)
    for front, behind, share in _hiding(tick.truth.people):
        style = {"arrowstyle": "-|>", "color": "0.15", "lw": 1.3, "shrinkA": 7, "shrinkB": 7}
        axes.annotate("", behind.position_m, front.position_m, arrowprops=style, zorder=6)
        x, y = (np.array(front.position_m) + behind.position_m) / 2.0
        axes.text(x, y + 0.12, f"{share:.0%}", fontsize=9, ha="center", weight="bold", zorder=7)


def _hiding(people: tuple[PersonTruth, ...]) -> Iterator[tuple[PersonTruth, PersonTruth, float]]:
    """Yield the occluder, the occluded person and the occluded fraction."""
    known = {person.name: person for person in people}
    for behind in people:
        for name, share in behind.hidden_by.items():
            if name != BORDER and name in known and share >= LEAST_SHARE:
                yield known[name], behind, share


def _shade(person: PersonTruth) -> tuple[float, float, float]:
    red, green, blue = person_colour(person.id)
    return red / 255.0, green / 255.0, blue / 255.0


if __name__ == "__main__":
    overview().savefig(PATH, dpi=100, facecolor="white", pil_kwargs={"optimize": True})
    print(PATH)
