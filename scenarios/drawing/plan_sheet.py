"""Lay out the sheet of a plan, whole or in sections of a long corridor, and place its labels."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

_LETTER = 0.62  # width of a letter in font sizes
_LINE = 1.25  # height of a line in font sizes
_POINTS_PER_INCH = 72.0

Box = tuple[float, float, float, float]  # min x, min y, max x, max y [m]


@dataclass(slots=True)
class Labels:
    """Finds a free place for one word after another.

    Attributes:
        axes: where to write; its limits and the figure's size must be final.
        taken: boxes [m] that are written or drawn on.
    """

    axes: Axes
    taken: list[Box] = field(default_factory=list)

    def block(self, x: float, y: float, radius_m: float) -> None:
        """Keep words off a disc; one outside the axes keeps off nothing."""
        if not self._shows(x, y):
            return
        self.taken.append((x - radius_m, y - radius_m, x + radius_m, y + radius_m))

    def write(self, x: float, y: float, text: str, *, size: float = 7.0, **style: Any) -> None:
        """Write a word beside a point, where it covers least of what is there."""
        self.write_at((x, y, x, y), text, size=size, **style)

    def write_at(self, box: Box, text: str, *, size: float = 7.0, **style: Any) -> None:
        """Write a word in a box if it fits, else beside it, where it covers least of what is there.

        Of what lies outside the axes nothing is written.
        """
        if not self._shows(*_middle(box)):
            return
        unit = self._metres_per_point() * size
        lines = text.split("\n")
        extent = (_LETTER * unit * max(map(len, lines)), _LINE * unit * len(lines))
        places = _inside(box, extent) + [
            _beside(box, extent, gap, angle)
            for gap in (0.4 * unit, 1.0 * unit, 2.0 * unit)
            for angle in range(0, 360, 30)
        ]
        best = min(places, key=lambda place: self._cost(place, *_middle(box)))
        self.taken.append(best)
        self.axes.text(
            *_middle(best),
            text,
            fontsize=size,
            ha="center",
            va="center",
            zorder=9,
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
            **style,
        )

    def _metres_per_point(self) -> float:
        figure = self.axes.get_figure()
        assert figure is not None
        inches = self.axes.get_window_extent().width / figure.get_dpi()
        low, high = self.axes.get_xlim()
        return (high - low) / (inches * _POINTS_PER_INCH)

    def _cost(self, place: Box, x: float, y: float) -> float:
        covered = sum(_shared(place, other) for other in self.taken)
        outside = _area(place) - _shared(place, self._view())
        return 20.0 * covered + 50.0 * outside + 0.02 * math.dist(_middle(place), (x, y))

    def _shows(self, x: float, y: float) -> bool:
        left, low, right, high = self._view()
        return left <= x <= right and low <= y <= high

    def _view(self) -> Box:
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        return left, low, right, high


def _inside(box: Box, extent: tuple[float, float]) -> list[Box]:
    """Places in the middle, at the top and at the bottom of a box; none if it is too small."""
    room = box[3] - box[1] - extent[1]
    if box[2] - box[0] < extent[0] or room < 0.0:
        return []
    x, y = _middle(box)
    return [_around(x, y + 0.4 * share * room, extent) for share in (0.0, 1.0, -1.0)]


def _beside(box: Box, extent: tuple[float, float], gap: float, degrees: float) -> Box:
    """A place in a direction from a box, clear of it by a gap."""
    x, y = _middle(box)
    u = x + math.cos(math.radians(degrees)) * (gap + (box[2] - box[0] + extent[0]) / 2.0)
    v = y + math.sin(math.radians(degrees)) * (gap + (box[3] - box[1] + extent[1]) / 2.0)
    return _around(u, v, extent)


def _around(x: float, y: float, extent: tuple[float, float]) -> Box:
    return x - extent[0] / 2.0, y - extent[1] / 2.0, x + extent[0] / 2.0, y + extent[1] / 2.0


def _middle(box: Box) -> tuple[float, float]:
    return (box[0] + box[2]) / 2.0, (box[1] + box[3]) / 2.0


def _area(box: Box) -> float:
    return max(box[2] - box[0], 0.0) * max(box[3] - box[1], 0.0)


def _shared(a: Box, b: Box) -> float:
    across, along = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return across * along if across > 0.0 and along > 0.0 else 0.0


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
