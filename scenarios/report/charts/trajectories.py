"""The plan of a run with the ways that people and robot really went, as a picture for a page."""

from __future__ import annotations

import base64
import io

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from peopleboy.scenarios.drawing.labels import Labels
from peopleboy.scenarios.drawing.plan_place import draw_floor, draw_things, draw_walls
from peopleboy.scenarios.drawing.plan_sheet import PAPER, lay_out, sections
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.findings.spans import Floats
from peopleboy.scenarios.report.findings.story import Story
from peopleboy.scenarios.report.findings.summary import Outcome

_WIDTH_IN = 4.3  # such that its letters are as large as the page's on a phone
_COLOURS = (
    "#0072b2",
    "#a8327a",
    "#2f7d32",
    "#b35c00",
    "#5d4a1f",
    "#00798c",
)  # told apart with any colour vision
_ROBOT = "#c0392b"
_MARK_EVERY_S = 5.0


def draw_trajectories(outcome: Outcome) -> str | None:
    """Draw the plan as an SVG data address; None if the place cannot be built again."""
    scenario = outcome.run.scenario
    if scenario is None:
        return None
    figure = Figure(facecolor=PAPER)
    FigureCanvasSVG(figure)
    for axes in lay_out(figure, sections(scenario.place.bounds), _WIDTH_IN, head_in=0.05, foot_in=0.3):
        _draw_section(axes, scenario, outcome)
    buffer = io.BytesIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "plan", "font.family": "sans-serif"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None}, facecolor=PAPER)
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def person_ink(outcome: Outcome, story: Story) -> str:
    """The colour of a person's way."""
    return _COLOURS[outcome.stories.index(story) % len(_COLOURS)]


def _draw_section(axes: Axes, scenario: Scenario, outcome: Outcome) -> None:
    labels = Labels(axes)
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_things(axes, labels, scenario.place)
    robot = np.stack([outcome.run.robot[key].to_numpy() for key in ("x_m", "y_m")], axis=1)
    _draw_way(axes, labels, robot, _ROBOT, "robot", outcome.run.rate_hz)
    for story in outcome.stories:
        colour = person_ink(outcome, story)
        way = story.position_m
        axes.plot(*way.T, color=colour, lw=0.8, alpha=0.8, ls=(0, (1, 2)), zorder=6)
        tracked = np.where((story.track > 0)[:, None], way, np.nan)
        _draw_way(axes, labels, way, colour, spoken(story.name), outcome.run.rate_hz, tracked)
    for change in outcome.changes:
        story = next(story for story in outcome.stories if story.name == change.person)
        x, y = story.position_m[change.first_frame - 1]
        axes.plot(x, y, "X", ms=8, mfc="#d55e00", mec="white", mew=0.8, zorder=9)
        labels.write(x, y, f"{change.old} to {change.new}", size=7, color="#a04400", weight="bold")


def _draw_way(
    axes: Axes,
    labels: Labels,
    way: Floats,
    colour: str,
    name: str,
    rate_hz: float,
    solid: Floats | None = None,
) -> None:
    """Draw where somebody went: a disc and the name at the start, small marks every five seconds."""
    axes.plot(*(way if solid is None else solid).T, color=colour, lw=1.8, zorder=7)
    there = np.flatnonzero(np.isfinite(way[:, 0]))
    if len(there) == 0:
        return
    x, y = way[there[0]]
    axes.plot(x, y, "o", ms=7, mfc=colour, mec="white", zorder=8)
    marks = way[there[0] :: round(_MARK_EVERY_S * rate_hz)]
    axes.plot(*marks[1:].T, "o", ms=3, mfc="white", mec=colour, mew=0.9, zorder=8)
    labels.block(x, y, 0.15)
    labels.write(x, y, name, size=8.5, color=colour, weight="bold")
