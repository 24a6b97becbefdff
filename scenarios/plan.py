"""The plan of a scenario: the place from above, warm things, people's ways and times, the robot's view."""

from __future__ import annotations

import textwrap
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from bad_input import BadInput
from scenarios.labels import Labels
from scenarios.plan_people import draw_person
from scenarios.plan_place import SPAN_C, WARMTH, draw_floor, draw_things, draw_walls, label_things
from scenarios.plan_robot import draw_robot
from scenarios.scenario import Scenario

PAPER, INK = "#fbfaf7", "#2b2d30"
_PEOPLE = ("#1f6fb4", "#2f7d32", "#7b3fa0", "#a8327a", "#00798c", "#5d4a1f")
_WIDTH_IN, _HEAD_IN, _FOOT_IN, _SIDE_IN, _DPI = 11.0, 0.85, 0.45, 0.25, 130
_BAR_IN = 0.9  # for the scale of temperatures on the right
_MARGIN_M = 0.4


def draw_plan(scenario: Scenario, seed: int, path: Path) -> None:
    """Draw a scenario as it is played with a seed, and save the picture.

    Args:
        scenario: what to draw.
        seed: whose variations to draw.
        path: of the picture, such as plan.png.
    """
    config = scenario.world(seed)
    figure, axes = _paper(scenario)
    labels = Labels(axes)
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_robot(axes, labels, scenario, config.robot)
    draw_things(axes, labels, scenario.place)
    for index, person in enumerate(config.people):
        draw_person(axes, labels, person, scenario.duration_s, _PEOPLE[index % len(_PEOPLE)])
    label_things(labels, scenario.place)
    _caption(figure, axes, scenario, seed)
    try:
        figure.savefig(path, dpi=_DPI)
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot write the plan: {error}; give a path that ends in .png") from error


def _paper(scenario: Scenario) -> tuple[Figure, Axes]:
    """A sheet whose height follows from the place's shape, one scale for both axes."""
    min_x, min_y, max_x, max_y = scenario.place.bounds
    width_m, height_m = max_x - min_x + 2.0 * _MARGIN_M, max_y - min_y + 2.0 * _MARGIN_M
    inner = _WIDTH_IN - 2.0 * _SIDE_IN - _BAR_IN
    drawn = min(inner * height_m / width_m, 8.5)
    total = drawn + _HEAD_IN + _FOOT_IN
    figure = Figure(figsize=(_WIDTH_IN, total), dpi=_DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    used = drawn * width_m / height_m
    left = _SIDE_IN + (inner - used) / 2.0
    axes = figure.add_axes(
        (left / _WIDTH_IN, _FOOT_IN / total, used / _WIDTH_IN, drawn / total), facecolor=PAPER
    )
    axes.set_xlim(min_x - _MARGIN_M, max_x + _MARGIN_M)
    axes.set_ylim(min_y - _MARGIN_M, max_y + _MARGIN_M)
    axes.set_axis_off()
    return figure, axes


def _caption(figure: Figure, axes: Axes, scenario: Scenario, seed: int) -> None:
    height = figure.get_figheight()
    left = _SIDE_IN / _WIDTH_IN
    figure.text(left, 1.0 - 0.26 / height, scenario.name, size=15, weight="bold", color=INK, va="center")
    about = textwrap.fill(scenario.description, 140)
    figure.text(left, 1.0 - 0.5 / height, about, size=8.5, color=INK, va="top", linespacing=1.35)
    lights = ", ".join(f"{100.0 * light.level:g} % at {light.at_s:g} s" for light in scenario.spec.lights)
    facts = [f"seed {seed}", f"{scenario.duration_s:g} s", f"robot: {scenario.robot.behaviour}"]
    note = "   ·   ".join([*facts, *([f"light: {lights}"] if lights else [])])
    figure.text(1.0 - left, 1.0 - 0.26 / height, note, size=8.5, color=INK, va="center", ha="right")
    _scale_bar(axes)
    box = axes.get_position()
    bar = figure.add_axes(
        (1.0 - 0.72 / _WIDTH_IN, box.y0 + 0.15 * box.height, 0.12 / _WIDTH_IN, 0.7 * box.height)
    )
    figure.colorbar(ScalarMappable(SPAN_C, WARMTH), cax=bar, extend="both")
    bar.set_title("°C", size=8, color=INK)
    bar.tick_params(labelsize=7, colors=INK)


def _scale_bar(axes: Axes) -> None:
    """Two metres, below the plan."""
    (left, _), (low, _) = axes.get_xlim(), axes.get_ylim()
    x = left + _MARGIN_M
    axes.plot([x, x + 2.0], [low, low], color=INK, lw=2.0, solid_capstyle="butt", clip_on=False)
    axes.annotate(
        "2 m", (x + 1.0, low), (0, -4), textcoords="offset points", size=7, ha="center", va="top", color=INK
    )
