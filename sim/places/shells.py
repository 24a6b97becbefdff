"""Shells of places, built from a floor plan: floor, walls and doors; a ceiling, or houses and a sky."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from peopleboy.sim.places.floor_plan import WALL_M, Door, FloorPlan, Rectangle, Wall, WallSide
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Covering, Material, Pattern, PatternKind
from peopleboy.sim.shapes.shapes import Part, Shape, ShapeKind

# Adjoining blocks overlap by this much, so that no two faces are coplanar.
SINK_M = 0.05

_LEAF_M = 0.03  # distance of a closed door's leaf from its wall
_FAR_M = 30.0  # distance from the street to the end of the world
_SKY_M = 24.0  # height of the sky
_STEP_M = 0.02  # depth of the ground beyond the walkable area
_LOBBY_M = 2.6  # height of the walls of a lobby
_HORIZON = {WallSide.NORTH: "north", WallSide.SOUTH: "south", WallSide.EAST: "east", WallSide.WEST: "west"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Surfaces:
    """Materials of the shell of a place.

    Attributes:
        floor, ceiling, walls, door: materials; that of a door is for its closed leaf.
        named: materials of single walls, by name.
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
        """Return the material of one wall."""
        return self.named.get(wall.name, self.walls)


def room_shell(plan: FloorPlan, height_m: float, materials: Surfaces) -> tuple[Fixture, ...]:
    """Build the fixtures of rooms and corridors: a ray from any point inside hits a surface.

    No two visible faces are coplanar and overlap.
    """
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
        # Narrower than the wall and recessed into the jambs, so that no faces are coplanar.
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
    """Make an upright block on a rectangle of floor, from one height to another [m]."""
    x, y = block.centre
    size = (block.max_x - block.min_x, block.max_y - block.min_y, top_m - bottom_m)
    shape = Shape(kind=ShapeKind.BOX, size=size)
    return Fixture(
        name=name,
        part=Part(name=name, shapes=(shape,), material=material),
        position=(x, y, (bottom_m + top_m) / 2.0),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class StreetLook:
    """Additional settings of a street.

    Attributes:
        houses: names of the walls that are house fronts; the others are absent.
        house_m: [m] height of the houses.
        sky_c: [degC] apparent temperature of the sky at the horizon.
    """

    houses: frozenset[str]
    house_m: float
    sky_c: float


def street_shell(plan: FloorPlan, look: StreetLook, surfaces: Surfaces) -> tuple[Fixture, ...]:
    """Build the fixtures of a street: a ray from any point on it hits a surface."""
    far = plan.bounds().grown(_FAR_M)
    street = replace(surfaces.floor, covering=Covering.STREET, colour_pattern=Pattern(), shine=0.0)
    sky = Material(
        temperature_c=look.sky_c, emissivity=1.0, rgb=(0.36, 0.5, 0.72), glow=0.45, covering=Covering.SKY
    )
    houses = tuple(
        block_fixture(
            f"wall_{wall.name}/{number}",
            block,
            -SINK_M,
            look.house_m if wall.name in look.houses else _LOBBY_M,
            replace(
                surfaces.of_wall(wall),
                covering=Covering.FACADE if wall.name in look.houses else Covering.PLASTER,
            ),
        )
        for number, (wall, block) in enumerate(plan.wall_pieces(), start=1)
        if wall.name in look.houses or wall.name.startswith("door_")
    )
    return (
        block_fixture("floor", plan.bounds().grown(SINK_M), -2.0 * SINK_M, 0.0, street),
        block_fixture("floor/far", far.grown(SINK_M), -3.0 * SINK_M, -_STEP_M, street),
        replace(
            block_fixture("ceiling", far.grown(SINK_M), _SKY_M, _SKY_M + 2.0 * SINK_M, sky), is_solid=False
        ),
        *(_horizon(name, side.strip(far, WALL_M), sky) for side, name in _HORIZON.items()),
        *houses,
        *(
            build_door(plan, number, door, look.house_m - SINK_M, _fronts(surfaces))
            for number, door in enumerate(plan.doors, start=1)
        ),
    )


def _fronts(surfaces: Surfaces) -> Surfaces:
    """Return the materials with those of houses on every wall."""
    named = {name: replace(look, covering=Covering.FACADE) for name, look in surfaces.named.items()}
    return replace(surfaces, walls=replace(surfaces.walls, covering=Covering.FACADE), named=named)


def _horizon(name: str, strip: Rectangle, sky: Material) -> Fixture:
    material = replace(sky, covering=Covering.SKYLINE)
    fixture = block_fixture(f"wall_horizon/{name}", strip, -SINK_M, _SKY_M + SINK_M, material)
    return replace(fixture, is_solid=False)
