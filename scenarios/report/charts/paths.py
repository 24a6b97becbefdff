"""Draw the plan of a run with the actual paths of people and robot."""

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.plan_sheet import (
    PAPER,
    Labels,
    draw_floor,
    draw_things,
    draw_walls,
    lay_out,
    sections,
)
from peopleboy.scenarios.report.findings.histories import Floats
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.page_parts import inline, new_figure, svg_style

_WIDTH_IN = 4.3  # its text has the page's font size on a phone
# Distinct with any colour vision.
_COLOURS = ("#0072b2", "#a8327a", "#2f7d32", "#b35c00", "#5d4a1f", "#00798c", "#7b3fa0", "#4a4a4a", "#6d7500")
_ROBOT = "#c0392b"
_MARK_EVERY_S = 5.0


@svg_style
def draw_paths(found: RunFindings, label: str) -> Markup | None:
    """Draw the plan; return None if the place cannot be rebuilt."""
    try:
        place = found.run.scenario.place
    except BadInput:
        return None
    figure = new_figure(1.0, 1.0)
    figure.set_facecolor(PAPER)
    for axes in lay_out(figure, sections(place.bounds), _WIDTH_IN, head_in=0.05, foot_in=0.3):
        _draw_section(axes, found)
    names = ", ".join(spoken(person.name) for person in found.people) or "no person"
    words = f"Plan of the place from above, with the paths of the robot and of {names}"
    return inline(figure, f"paths {label}", words)


def _draw_section(axes: Axes, found: RunFindings) -> None:
    labels, scenario, rate_hz = Labels(axes), found.run.scenario, found.run.rate_hz
    draw_floor(axes, scenario.plan)
    draw_walls(axes, labels, scenario.place)
    draw_things(axes, labels, scenario.place)
    robot = np.stack([found.files.robot[key].to_numpy() for key in ("x_m", "y_m")], axis=1)
    _draw_path(axes, labels, robot, robot, _ROBOT, "robot", rate_hz)
    for number, person in enumerate(found.people):
        colour, way = _COLOURS[number % len(_COLOURS)], person.position_m
        axes.plot(*way.T, color=colour, lw=0.8, alpha=0.8, ls=(0, (1, 2)), zorder=6)
        tracked = np.where((person.track > 0)[:, None], way, np.nan)
        _draw_path(axes, labels, way, tracked, colour, spoken(person.name), rate_hz)
    for change in found.changes:
        x, y = found.called(change.person).position_m[change.first_frame - 1]
        axes.plot(x, y, "X", ms=8, mfc="#d55e00", mec="white", mew=0.8, zorder=9)
        labels.write(x, y, f"{change.old} to {change.new}", size=7, color="#a04400", weight="bold")


def _draw_path(
    axes: Axes, labels: Labels, way: Floats, thick: Floats, colour: str, name: str, rate_hz: float
) -> None:
    """Draw a path: a disc and the name at its start, and small marks every five seconds."""
    axes.plot(*thick.T, color=colour, lw=1.8, zorder=7)
    there = np.flatnonzero(np.isfinite(way[:, 0]))
    if len(there) == 0:
        return
    x, y = way[there[0]]
    axes.plot(x, y, "o", ms=7, mfc=colour, mec="white", zorder=8)
    marks = way[there[0] :: round(_MARK_EVERY_S * rate_hz)]
    axes.plot(*marks[1:].T, "o", ms=3, mfc="white", mec=colour, mew=0.9, zorder=8)
    labels.block(x, y, 0.15)
    labels.write(x, y, name, size=8.5, color=colour, weight="bold")
