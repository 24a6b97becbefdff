"""Rooms and corridors: floor, ceiling, walls and doors as fixtures, built from a floor plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.places.extent import fixture_extent
from peopleboy.sim.places.floor_plan import Door, FloorPlan, Rectangle, Wall, check_doors
from peopleboy.sim.places.moving import Mover
from peopleboy.sim.places.place import Fixture, Place, Sun, is_in_the_way
from peopleboy.sim.shapes.materials import Covering, Material, Pattern, PatternKind
from peopleboy.sim.shapes.shapes import Part, Shape, ShapeKind

# Blocks that meet run this far into each other, so that no two faces lie in one plane.
SINK_M = 0.05

_LEAF_M = 0.03  # how far a closed door's leaf stands out of its wall


@dataclass(frozen=True, slots=True, kw_only=True)
class Surfaces:
    """Looks of the shell of a place.

    Attributes:
        floor, ceiling, walls, door: looks; a door's is that of its closed leaf.
        named: looks of single walls, by the wall's name.
    """

    floor: Material = field(
        default_factory=lambda: Material(
            temperature_c=20.0,
            emissivity=0.95,
            variation_k=0.4,
            variation_m=2.5,
            rgb=(0.42, 0.36, 0.30),
            second_rgb=(0.36, 0.31, 0.26),
            colour_pattern=Pattern(kind=PatternKind.CHECKS, period_m=1.0),
            covering=Covering.FLOORING,
        )
    )
    ceiling: Material = field(
        default_factory=lambda: Material(
            temperature_c=22.8,
            emissivity=0.93,
            variation_k=0.3,
            variation_m=3.0,
            rgb=(0.80, 0.80, 0.78),
            covering=Covering.CEILING,
        )
    )
    walls: Material = field(
        default_factory=lambda: Material(
            temperature_c=21.5,
            emissivity=0.93,
            variation_k=0.5,
            variation_m=1.8,
            rgb=(0.72, 0.69, 0.60),
            covering=Covering.PLASTER,
        )
    )
    door: Material = field(
        default_factory=lambda: Material(temperature_c=21.0, emissivity=0.92, rgb=(0.38, 0.22, 0.11))
    )
    named: Mapping[str, Material] = field(default_factory=dict)

    def of_wall(self, wall: Wall) -> Material:
        """The look of one wall."""
        return self.named.get(wall.name, self.walls)


def straight_corridor(length_m: float, width_m: float) -> FloorPlan:
    """A corridor or a rectangular room: length along x from x = 0, width centred on y = 0."""
    return FloorPlan(areas=(("", Rectangle(0.0, -width_m / 2.0, length_m, width_m / 2.0)),))


def l_corridor(
    first_m: float, second_m: float, width_m: float, turn: Literal["left", "right"] = "left"
) -> FloorPlan:
    """A corridor along x from x = 0 whose end turns to the left (+y) or right (-y).

    Args:
        first_m: [m] length of the first leg, including the corner.
        second_m: [m] length of the second leg beyond the first one's side.
        width_m: [m] width of both.
        turn: where the second leg goes.
    """
    half = width_m / 2.0
    left, right = first_m - width_m, first_m
    second = (
        Rectangle(left, half, right, half + second_m)
        if turn == "left"
        else Rectangle(left, -half - second_m, right, -half)
    )
    return FloorPlan(areas=(("first", Rectangle(0.0, -half, first_m, half)), ("second", second)))


def t_corridor(stem_m: float, bar_m: float, width_m: float) -> FloorPlan:
    """A corridor along x from x = 0 that ends in the middle of a corridor along y.

    Args:
        stem_m: [m] length of the stem up to the bar.
        bar_m: [m] length of the bar.
        width_m: [m] width of both.
    """
    half = width_m / 2.0
    bar = Rectangle(stem_m, -bar_m / 2.0, stem_m + width_m, bar_m / 2.0)
    return FloorPlan(areas=(("stem", Rectangle(0.0, -half, stem_m, half)), ("bar", bar)))


def build_place(
    plan: FloorPlan,
    *,
    height_m: float = 2.7,
    surfaces: Surfaces | None = None,
    shell: tuple[Fixture, ...] | None = None,
    things: tuple[Fixture, ...] = (),
    surroundings_c: float = 21.0,
    light: tuple[tuple[float, float], ...] = ((0.0, 1.0),),
    movers: tuple[Mover, ...] = (),
    sun: Sun | None = None,
) -> Place:
    """Build the shell of a place, unless one is given, and put things into it, some of which are moved.

    No two visible faces of the shell lie in one plane and overlap, and the inside is closed all around:
    a ray from any point of the floor plan meets a surface.

    Raises:
        BadInput: a door does not fit.
    """
    check_doors(plan)
    materials = Surfaces() if surfaces is None else surfaces
    fixtures = (*(_shell(plan, height_m, materials) if shell is None else shell), *things)
    moved = {mover.name for mover in movers}
    names, boxes = obstacles(tuple(f for f in fixtures if f.name.split("/")[0] not in moved))
    bounds = plan.bounds()
    return Place(
        fixtures=fixtures,
        obstacles=boxes,
        obstacle_names=names,
        bounds=(bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y),
        surroundings_c=surroundings_c,
        light=light,
        movers=movers,
        sun=sun,
    )


def obstacles(fixtures: tuple[Fixture, ...]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """List everything solid that a walking person can bump into.

    Returns:
        The K names, and (K, 4) [m] min x, min y, max x, max y.
    """
    blocking = [
        (fixture.name.split("/")[0], extent[:, :2].ravel())
        for fixture in fixtures
        if fixture.is_solid
        for extent in [fixture_extent(fixture)]
        if is_in_the_way(extent[0, 2], extent[1, 2])
    ]
    boxes = np.array([box for _, box in blocking], float).reshape(-1, 4)
    boxes.setflags(write=False)
    return tuple(name for name, _ in blocking), boxes


def _shell(plan: FloorPlan, height_m: float, materials: Surfaces) -> tuple[Fixture, ...]:
    outside = plan.bounds().grown(SINK_M)
    walls = tuple(
        block_fixture(
            f"wall_{wall.name}/{number}", block, -SINK_M, height_m + SINK_M, materials.of_wall(wall)
        )
        for number, (wall, block) in enumerate(plan.wall_pieces(), start=1)
    )
    return (
        block_fixture("floor", outside, -2.0 * SINK_M, 0.0, materials.floor),
        block_fixture("ceiling", outside, height_m, height_m + 2.0 * SINK_M, materials.ceiling),
        *walls,
        *(
            build_door(plan, number, door, height_m, materials)
            for number, door in enumerate(plan.doors, start=1)
        ),
    )


def build_door(plan: FloorPlan, number: int, door: Door, height_m: float, materials: Surfaces) -> Fixture:
    """Build the lintel over an open door, up to a height [m], or the leaf of a closed one."""
    wall, opening = plan.wall(door.wall), plan.opening(door)
    nx, ny = (abs(part) for part in wall.side.value)
    if door.is_open:
        # Narrower than the wall and let into the jambs: its faces lie in no other face's plane.
        inset, reach = 0.01, SINK_M / 2.0
        lintel = Rectangle(
            opening.min_x + nx * inset - ny * reach,
            opening.min_y + ny * inset - nx * reach,
            opening.max_x - nx * inset + ny * reach,
            opening.max_y - ny * inset + nx * reach,
        )
        top = height_m + SINK_M / 2.0
        return block_fixture(f"door_{number}/lintel", lintel, door.height_m, top, materials.of_wall(wall))
    inward = [-_LEAF_M * part for part in wall.side.value]
    leaf = Rectangle(
        opening.min_x + inward[0],
        opening.min_y + inward[1],
        opening.max_x + inward[0],
        opening.max_y + inward[1],
    )
    return block_fixture(f"door_{number}/leaf", leaf, -SINK_M / 2.0, door.height_m, materials.door)


def block_fixture(name: str, block: Rectangle, bottom_m: float, top_m: float, material: Material) -> Fixture:
    """An upright block on a rectangle of floor, from one height to another [m]."""
    x, y = block.centre
    size = (block.max_x - block.min_x, block.max_y - block.min_y, top_m - bottom_m)
    shape = Shape(kind=ShapeKind.BOX, size=size)
    return Fixture(
        name=name,
        part=Part(name=name, shapes=(shape,), material=material),
        position=(x, y, (bottom_m + top_m) / 2.0),
    )
