"""The sheet of a plan: one drawing of the whole place, or, of a long corridor, one below the other."""

from __future__ import annotations

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from peopleboy.scenarios.drawing.labels import Box

PAPER, INK = "#fbfaf7", "#2b2d30"
MARGIN_M = 0.4
_LONGEST = 4.5  # times as long as wide: beyond that a place is cut into sections
_SECTION = 3.0  # about that long is a section
_OVERLAP_M = 0.5  # that two neighbouring sections both show
_TALLEST_IN = 8.5
_GAP_IN = 0.32


def sections(bounds: Box) -> list[Box]:
    """Cut a place's bounds (min x, min y, max x, max y [m]) into pieces of equal size, if it is a long strip.

    Strips along x are cut; those along y are drawn tall as they are.
    """
    low_x, low_y, high_x, high_y = bounds
    low_x, low_y, high_x, high_y = low_x - MARGIN_M, low_y - MARGIN_M, high_x + MARGIN_M, high_y + MARGIN_M
    length, width = high_x - low_x, high_y - low_y
    count = 1 if length <= _LONGEST * width else math.ceil(length / (_SECTION * width))
    size = (length + (count - 1) * _OVERLAP_M) / count
    starts = [low_x + k * (size - _OVERLAP_M) for k in range(count)]
    return [(start, low_y, start + size, high_y) for start in starts]


def lay_out(
    figure: Figure,
    pieces: list[Box],
    width_in: float,
    *,
    head_in: float,
    foot_in: float,
    side_in: tuple[float, float] = (0.05, 0.05),
) -> list[Axes]:
    """Size a figure for some sections of a plan, one scale for all, and give their axes from top to bottom.

    Args:
        figure: to be drawn on.
        pieces: the sections, of one size [m].
        width_in: of the figure [inch].
        head_in: room left above [inch].
        foot_in: below.
        side_in: on the left and on the right.
    """
    low_x, low_y, high_x, high_y = pieces[0]
    inner = width_in - sum(side_in)
    drawn = min(inner * (high_y - low_y) / (high_x - low_x), _TALLEST_IN)
    used = drawn * (high_x - low_x) / (high_y - low_y)
    total = head_in + len(pieces) * drawn + (len(pieces) - 1) * _GAP_IN + foot_in
    figure.set_size_inches(width_in, total)
    found = []
    for number, (start, low, end, high) in enumerate(pieces):
        bottom = total - head_in - (number + 1) * drawn - number * _GAP_IN
        left = side_in[0] + (inner - used) / 2.0
        axes = figure.add_axes((left / width_in, bottom / total, used / width_in, drawn / total))
        axes.set_xlim(start, end)
        axes.set_ylim(low, high)
        axes.set_axis_off()
        found.append(axes)
    _scale_bar(found[-1])
    if len(pieces) > 1:
        for axes in found:
            _name_section(axes)
    return found


def _name_section(axes: Axes) -> None:
    low, high = axes.get_xlim()
    axes.text(
        1.0, -0.01, f"x = {low:.1f} to {high:.1f} m", transform=axes.transAxes,
        size=7, color=INK, ha="right", va="top",
    )  # fmt: skip


def _scale_bar(axes: Axes) -> None:
    """Two metres, below the plan."""
    left, low = axes.get_xlim()[0], axes.get_ylim()[0]
    x = left + MARGIN_M
    axes.plot([x, x + 2.0], [low, low], color=INK, lw=2.0, solid_capstyle="butt", clip_on=False)
    axes.annotate(
        "2 m", (x + 1.0, low), (0, -4), textcoords="offset points", size=7, ha="center", va="top", color=INK
    )
