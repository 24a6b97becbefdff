"""The room or corridor in which everything happens."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from peopleboy.scenarios.files.schema.values import Celsius, Colour, Coordinate, Key, Strict

Length = Annotated[float, Field(ge=1.5, le=100.0)]


class DoorSpec(Strict):
    """A door in a wall. An open one leads to a small lobby, in which people wait out of sight."""

    wall: Key = Field(
        description="name of the wall: north, south, east or west; in L and T corridors after the leg, as in "
        "first_north"
    )
    along_m: Coordinate = Field(
        description="middle of the door: world x in a north or south wall, world y in an east or west wall"
    )
    width_m: float = Field(default=0.95, ge=0.7, le=4.0, description="width of the opening")
    height_m: float = Field(default=2.05, ge=1.9, le=3.0, description="height of the opening")
    open: bool = Field(default=True, description="a closed door is a leaf on the wall, with nothing behind")
    lobby_m: float = Field(default=1.5, ge=1.0, le=6.0, description="depth of the lobby behind an open door")


class TemperaturesSpec(Strict):
    """Surface temperatures of the place itself."""

    floor_c: Celsius = Field(default=20.0, description="of the floor")
    ceiling_c: Celsius = Field(default=22.8, description="of the ceiling")
    walls_c: Celsius = Field(default=21.5, description="of all walls that `single_walls_c` does not name")
    single_walls_c: dict[Key, Celsius] = Field(
        default={}, description="walls that differ, by name, such as an outer wall in winter"
    )
    surroundings_c: Celsius = Field(default=21.0, description="what surfaces of low emissivity mirror")


class ColoursSpec(Strict):
    """Colours of the place itself: names, or linear red, green and blue from 0 to 1."""

    floor: Colour | None = Field(default=None, description="colour of the floor")
    ceiling: Colour | None = Field(default=None, description="colour of the ceiling")
    walls: Colour | None = Field(default=None, description="colour of the walls")
    doors: Colour | None = Field(default=None, description="colour of closed doors")


class _AnyPlace(Strict):
    width_m: float = Field(ge=1.2, le=60.0, description="across; of L and T corridors, of both legs")
    height_m: float = Field(default=2.7, ge=2.2, le=8.0, description="from the floor to the ceiling")
    doors: tuple[DoorSpec, ...] = Field(default=(), strict=False, description="openings in its walls")
    temperatures: TemperaturesSpec = Field(default=TemperaturesSpec(), description="of its surfaces")
    colours: ColoursSpec = Field(default=ColoursSpec(), description="of its surfaces")
    floor_shine: float = Field(
        default=0.3,
        ge=0.0,
        le=1.0,
        description="how much of what the floor reflects it mirrors, from 0, a carpet, to 1, polished stone; "
        "seen with `detail: full`",
    )


class RoomSpec(_AnyPlace):
    """A rectangular room: x from 0 to length, y to half the width on either side."""

    kind: Literal["room"] = Field(description="a rectangular room")
    length_m: Length = Field(description="how far it reaches along x")


class CorridorSpec(_AnyPlace):
    """A straight corridor: x from 0 to length, y to half the width on either side."""

    kind: Literal["corridor"] = Field(description="a straight corridor")
    length_m: Length = Field(description="how far it reaches along x")


class LCorridorSpec(_AnyPlace):
    """A corridor along x from 0 whose end turns aside."""

    kind: Literal["l_corridor"] = Field(description="a corridor with a corner")
    first_m: Length = Field(description="length of the first leg, with the corner")
    second_m: Length = Field(description="length of the second leg beyond the first one's side")
    turn: Literal["left", "right"] = Field(
        default="left", description="the side to which the second leg leads"
    )


class TCorridorSpec(_AnyPlace):
    """A corridor along x from 0 that ends in the middle of a corridor along y."""

    kind: Literal["t_corridor"] = Field(description="a corridor with a junction at its end")
    stem_m: Length = Field(description="length of the corridor along x, up to the bar")
    bar_m: Length = Field(description="length of the corridor along y in which the stem ends")


PlaceSpec = Annotated[RoomSpec | CorridorSpec | LCorridorSpec | TCorridorSpec, Field(discriminator="kind")]
