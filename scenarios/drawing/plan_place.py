"""Draw the place on a plan: floor, walls, doors, and things in the colours of their temperatures."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from peopleboy.scenarios.drawing.plan_sheet import Box, Labels
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.places.extent import fixture_extent, shape_extent
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

Outline = NDArray[np.float64]  # (N, 2) [m] corners, world frame

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)


def footprints(fixture: Fixture) -> list[Outline]:
    """Outline every shape of a fixture from above; furniture from a file by the box around it."""
    if fixture.part is None:
        low, high = fixture_extent(fixture)[:, :2]
        return [np.array([low, [high[0], low[1]], high, [low[0], high[1]]])]
    world = pose_matrices(fixture.position, fixture.orientation)
    return [_hull(_surface_points(shape) @ world[:3, :3].T + world[:3, 3]) for shape in fixture.part.shapes]


def _surface_points(shape: Shape) -> NDArray[np.float64]:
    """Points (N, 3) of a shape's surface in its part's frame, whose hull is the shape or nearly so."""
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
_ROOM_C = (18.0, 25.0)  # nothing worth a figure
_OVERHEAD_M = 2.0


def draw_floor(axes: Axes, plan: FloorPlan) -> None:
    """Draw the floor, lobbies darker."""
    for index, area in enumerate(plan.walkable()):
        corner, width, height = (area.min_x, area.min_y), area.max_x - area.min_x, area.max_y - area.min_y
        colour = _FLOOR if index < len(plan.areas) else _LOBBY
        axes.add_patch(Rectangle(corner, width, height, facecolor=colour, lw=0.0, zorder=0))


def draw_walls(axes: Axes, labels: Labels, place: Place) -> None:
    """Draw walls; the lintel of an open door is a dashed line across the gap, a closed door its leaf."""
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
    """Draw things from above; what hangs overhead is only an outline, over which one may write."""
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
    """Name every thing, with its temperature if it is not the room's; the smallest first."""
    things = {name: fixtures for name, fixtures in _things(place).items() if not _is_overhead(fixtures)}
    for name, fixtures in sorted(things.items(), key=lambda item: _area(_box(item[1]))):
        warmest = max((_temperature(fixture) for fixture in fixtures), key=lambda c: abs(c - 21.0))
        number = "" if _ROOM_C[0] <= warmest <= _ROOM_C[1] else f"\n{warmest:g} °C"
        box = _box(fixtures)
        labels.taken.remove(box)  # a word may stand on its own thing
        labels.write_at(box, f"{name.replace('_', ' ')}{number}", size=6.2, color="#55585c")
        labels.taken.append(box)


def _things(place: Place) -> dict[str, list[Fixture]]:
    """Fixtures that are not the shell and are there at first, by the name of their thing."""
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


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _temperature(fixture: Fixture) -> float:
    material = fixture.part.material if fixture.part is not None else fixture.material
    assert material is not None
    return material.temperature_c
