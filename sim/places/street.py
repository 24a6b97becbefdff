"""A street: road and pavements, houses on either side, and a sky behind everything."""

from __future__ import annotations

from dataclasses import dataclass, replace

from peopleboy.sim.places.floor_plan import WALL_M, FloorPlan, Rectangle, WallSide
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.places.rooms import SINK_M, Surfaces, block_fixture, build_door
from peopleboy.sim.shapes.materials import Covering, Material, Pattern

_FAR_M = 30.0  # from the street to where the world ends
_SKY_M = 24.0  # how high the sky hangs
_STEP_M = 0.02  # how much lower it is where nobody walks
_LOBBY_M = 2.6  # how high the walls of a lobby are
_HORIZON = {WallSide.NORTH: "north", WallSide.SOUTH: "south", WallSide.EAST: "east", WallSide.WEST: "west"}


@dataclass(frozen=True, slots=True, kw_only=True)
class StreetLook:
    """What a street has that a room has not.

    Attributes:
        houses: names of the walls that are fronts of houses; the others are not there.
        house_m: [m] height of the houses.
        sky_c: [degC] what the sky seems to have at the horizon.
    """

    houses: frozenset[str]
    house_m: float
    sky_c: float


def street_shell(plan: FloorPlan, look: StreetLook, surfaces: Surfaces) -> tuple[Fixture, ...]:
    """Build the fixtures of a street: a ray from any point on it meets a surface."""
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
    """The looks with those of houses on every wall."""
    named = {name: replace(look, covering=Covering.FACADE) for name, look in surfaces.named.items()}
    return replace(surfaces, walls=replace(surfaces.walls, covering=Covering.FACADE), named=named)


def _horizon(name: str, strip: Rectangle, sky: Material) -> Fixture:
    material = replace(sky, covering=Covering.SKYLINE)
    fixture = block_fixture(f"wall_horizon/{name}", strip, -SINK_M, _SKY_M + SINK_M, material)
    return replace(fixture, is_solid=False)
