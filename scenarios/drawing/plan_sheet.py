"""Lay out the sheet of a plan, whole or in sections, place its labels, and draw the place."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.places.extent import fixture_extent, shape_extent
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

_LETTER = 0.62  # width of a letter, in font sizes
_LINE = 1.25  # height of a line, in font sizes
_POINTS_PER_INCH = 72.0

Box = tuple[float, float, float, float]  # min x, min y, max x, max y [m]


@dataclass(slots=True)
class Labels:
    """Places labels, one after the other, where they cover least.

    Attributes:
        axes: axes to write on; their limits and the figure's size must be final.
        taken: boxes [m] that are occupied.
    """

    axes: Axes
    taken: list[Box] = field(default_factory=list)

    def block(self, x: float, y: float, radius_m: float) -> None:
        """Keep labels off a disc; a disc outside the axes is ignored."""
        if not self._shows(x, y):
            return
        self.taken.append((x - radius_m, y - radius_m, x + radius_m, y + radius_m))

    def write(self, x: float, y: float, text: str, *, size: float = 7.0, **style: Any) -> None:
        """Write a label beside a point, where it covers least."""
        self.write_at((x, y, x, y), text, size=size, **style)

    def write_at(self, box: Box, text: str, *, size: float = 7.0, **style: Any) -> None:
        """Write a label in a box if it fits, else beside it, where it covers least.

        Nothing is written for a box outside the axes.
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
    """Return places in the middle, at the top and at the bottom of a box; none if it is too small."""
    room = box[3] - box[1] - extent[1]
    if box[2] - box[0] < extent[0] or room < 0.0:
        return []
    x, y = _middle(box)
    return [_around(x, y + 0.4 * share * room, extent) for share in (0.0, 1.0, -1.0)]


def _beside(box: Box, extent: tuple[float, float], gap: float, degrees: float) -> Box:
    """Return a place at an angle from a box, with a gap between them."""
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
_LONGEST = 4.5  # length over width; a longer place is drawn in sections
_SECTION = 3.0  # approximate length over width of a section
_OVERLAP_M = 0.5  # overlap of neighbouring sections
_TALLEST_IN = 8.5
_GAP_IN = 0.32


def sections(bounds: Box) -> list[Box]:
    """Split a place's bounds (min x, min y, max x, max y [m]) into equal sections, if it is a long strip.

    Only strips along x are split; strips along y are drawn as one tall plan.
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
    """Size a figure for the sections of a plan, at one scale, and return their axes from top to bottom.

    Args:
        figure: the figure to draw on.
        pieces: the sections, all of one size [m].
        width_in: width of the figure [inch].
        head_in: margin above [inch].
        foot_in: margin below [inch].
        side_in: margins on the left and on the right [inch].
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
    """Draw a scale bar of two metres below the plan."""
    left, low = axes.get_xlim()[0], axes.get_ylim()[0]
    x = left + MARGIN_M
    axes.plot([x, x + 2.0], [low, low], color=INK, lw=2.0, solid_capstyle="butt", clip_on=False)
    axes.annotate(
        "2 m", (x + 1.0, low), (0, -4), textcoords="offset points", size=7, ha="center", va="top", color=INK
    )


Outline = NDArray[np.float64]  # (N, 2) [m] corners, world frame

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)


def footprints(fixture: Fixture) -> list[Outline]:
    """Return the outline of every shape of a fixture from above; furniture from a file has a bounding box."""
    if fixture.part is None:
        low, high = fixture_extent(fixture)[:, :2]
        return [np.array([low, [high[0], low[1]], high, [low[0], high[1]]])]
    world = pose_matrices(fixture.position, fixture.orientation)
    return [_hull(_surface_points(shape) @ world[:3, :3].T + world[:3, 3]) for shape in fixture.part.shapes]


def _surface_points(shape: Shape) -> NDArray[np.float64]:
    """Return points (N, 3) in the part's frame whose convex hull approximates a shape."""
    low, high = shape_extent(shape)
    points = low + _CORNERS * (high - low)
    if shape.kind in (ShapeKind.CYLINDER, ShapeKind.SPHERE, ShapeKind.CAPSULE):
        ring = np.stack(
            [high[0] * np.cos(_CIRCLE), high[1] * np.sin(_CIRCLE), np.zeros_like(_CIRCLE)], axis=1
        )
        heights = (0.0,) if shape.kind == ShapeKind.SPHERE else (low[2], high[2])
        points = np.concatenate([ring + np.array([0.0, 0.0, z]) for z in heights])
    pose = pose_matrices(shape.position, shape.orientation)
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


def _hull(points: NDArray[np.float64]) -> Outline:
    flat = np.unique(np.round(points[:, :2], 6), axis=0)
    return np.asarray(flat[ConvexHull(flat).vertices])


WARMTH = LinearSegmentedColormap.from_list(
    "warmth",
    [
        (0.0, "#4f86bd"),
        (0.14, "#cbc8c0"),
        (0.24, "#ecdcab"),
        (0.45, "#e8a552"),
        (0.7, "#d2592f"),
        (1.0, "#8f1d2c"),
    ],
)
SPAN_C = Normalize(vmin=14.0, vmax=64.0)
_FLOOR, _LOBBY, _WALL, _EDGE, _LEAF = "#f2efe7", "#e6e1d5", "#4a4d52", "#5b5e63", "#9a6a3f"
_ROOM_C = (18.0, 25.0)  # temperatures that are not labelled
_OVERHEAD_M = 2.0


def draw_floor(axes: Axes, plan: FloorPlan) -> None:
    """Draw the floor, with lobbies in a darker colour."""
    for index, area in enumerate(plan.walkable()):
        corner, width, height = (area.min_x, area.min_y), area.max_x - area.min_x, area.max_y - area.min_y
        colour = _FLOOR if index < len(plan.areas) else _LOBBY
        axes.add_patch(Rectangle(corner, width, height, facecolor=colour, lw=0.0, zorder=0))


def draw_walls(axes: Axes, labels: Labels, place: Place) -> None:
    """Draw walls and closed doors; the lintel of an open door is a dashed line across the gap."""
    for fixture in place.fixtures:
        name = fixture.name
        if name.startswith("wall_") or name.endswith("/leaf"):
            colour = _LEAF if name.endswith("/leaf") else _WALL
            for corners in footprints(fixture):
                axes.add_patch(Polygon(corners, facecolor=colour, edgecolor=colour, lw=0.4, zorder=3))
                labels.taken.append((*corners.min(axis=0), *corners.max(axis=0)))
        elif name.endswith("/lintel"):
            for corners in footprints(fixture):
                axes.add_patch(
                    Polygon(corners, facecolor="none", edgecolor=_EDGE, lw=0.6, ls=(0, (2, 2)), zorder=3)
                )


def draw_things(axes: Axes, labels: Labels, place: Place) -> None:
    """Draw objects from above; overhead objects as outlines that labels may cover."""
    things = [fixture for fixtures in _things(place).values() for fixture in fixtures]
    labels.taken += [_box(fixtures) for fixtures in _things(place).values() if not _is_overhead(fixtures)]
    for fixture in sorted(things, key=lambda f: float(fixture_extent(f)[1, 2])):
        temperature = _temperature(fixture)
        is_overhead = _is_overhead([fixture])
        for corners in footprints(fixture):
            axes.add_patch(
                Polygon(
                    corners,
                    facecolor="none" if is_overhead else WARMTH(SPAN_C(temperature)),
                    edgecolor=WARMTH(SPAN_C(temperature)) if is_overhead else _EDGE,
                    lw=0.9 if is_overhead else 0.35,
                    ls=(0, (3, 2)) if is_overhead else "-",
                    zorder=4,
                )
            )


def name_things(labels: Labels, place: Place) -> None:
    """Label every object, with its temperature if it differs from the room's; the smallest first."""
    things = {name: fixtures for name, fixtures in _things(place).items() if not _is_overhead(fixtures)}
    for name, fixtures in sorted(things.items(), key=lambda item: _area_m2(_box(item[1]))):
        warmest = max((_temperature(fixture) for fixture in fixtures), key=lambda c: abs(c - 21.0))
        number = "" if _ROOM_C[0] <= warmest <= _ROOM_C[1] else f"\n{warmest:g} °C"
        box = _box(fixtures)
        labels.taken.remove(box)  # a label may cover its own object
        labels.write_at(box, f"{name.replace('_', ' ')}{number}", size=6.2, color="#55585c")
        labels.taken.append(box)


def _things(place: Place) -> dict[str, list[Fixture]]:
    """Return fixtures by object name, without floor, ceiling, walls, doors and objects hidden at start."""
    things: dict[str, list[Fixture]] = {}
    absent = {mover.name for mover in place.movers if mover.is_hidden_at_start}
    for fixture in place.fixtures:
        name = fixture.name.split("/")[0]
        if name not in ("floor", "ceiling", *absent) and not name.startswith(("wall_", "door_")):
            things.setdefault(name, []).append(fixture)
    return things


def _is_overhead(fixtures: list[Fixture]) -> bool:
    return all(fixture_extent(fixture)[0, 2] > _OVERHEAD_M for fixture in fixtures)


def _box(fixtures: list[Fixture]) -> Box:
    extents = np.array([fixture_extent(fixture)[:, :2] for fixture in fixtures])
    (left, low), (right, high) = extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)
    return float(left), float(low), float(right), float(high)


def _area_m2(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _temperature(fixture: Fixture) -> float:
    material = fixture.part.material if fixture.part is not None else fixture.material
    assert material is not None
    return material.temperature_c
