"""The room or corridor in which everything happens."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from peopleboy.scenarios.files.schema.values import Celsius, Colour, Coordinate, Degrees, Key, Strict

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


# Surfaces of a place against its air [K], where a file leaves them out but says how warm the air is.
_FROM_AIR = {"floor_c": -1.0, "ceiling_c": 1.8, "walls_c": 0.5, "surroundings_c": 0.0}


class TemperaturesSpec(Strict):
    """Surface temperatures of the place itself."""

    air_c: Celsius | None = Field(
        default=None,
        description="of the air: floor, ceiling, walls, surroundings, and things that are not heated "
        "follow it where they have no temperature of their own; left out, all is as at 21 degC",
    )
    floor_c: Celsius = Field(default=20.0, description="of the floor")
    ceiling_c: Celsius = Field(default=22.8, description="of the ceiling")
    walls_c: Celsius = Field(default=21.5, description="of all walls that `single_walls_c` does not name")
    single_walls_c: dict[Key, Celsius] = Field(
        default={}, description="walls that differ, by name, such as an outer wall in winter"
    )
    surroundings_c: Celsius = Field(default=21.0, description="what surfaces of low emissivity mirror")

    @model_validator(mode="before")
    @classmethod
    def _follow_the_air(cls, data: Any) -> Any:
        """Fill in what follows from the air."""
        air = data.get("air_c") if isinstance(data, dict) else None
        if not isinstance(air, int | float) or not -40.0 <= air <= 60.0:
            return data
        return {key: air + offset for key, offset in _FROM_AIR.items()} | data


class ColoursSpec(Strict):
    """Colours of the place itself: names, or linear red, green and blue from 0 to 1."""

    floor: Colour | None = Field(default=None, description="colour of the floor")
    ceiling: Colour | None = Field(default=None, description="colour of the ceiling")
    walls: Colour | None = Field(default=None, description="colour of the walls")
    doors: Colour | None = Field(default=None, description="colour of closed doors")


class SunSpec(Strict):
    """Where the sun stands, and what it does to floor and walls that it reaches through windows."""

    azimuth_deg: Degrees = Field(description="where it stands: 0 is along x, 90 along y")
    elevation_deg: float = Field(ge=5.0, le=85.0, description="how high it stands above the horizon")
    warms_k: float = Field(
        default=8.0, ge=0.0, le=40.0, description="how much warmer it makes what it shines on"
    )
    brightens: float = Field(
        default=0.9, ge=0.0, le=5.0, description="how much brighter, as a share of the light without it"
    )


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
    sun: SunSpec | None = Field(
        default=None, description="the sun, which only `detail: full` shows; left out, there is none"
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


class StreetSpec(_AnyPlace):
    """A street along x from 0, y to half the width on either side: a road between two pavements, and sky."""

    kind: Literal["street"] = Field(description="a street, with houses and sky")
    length_m: Annotated[float, Field(ge=5.0, le=40.0)] = Field(description="how far one can walk along x")
    houses: Literal["both", "north", "south", "none"] = Field(
        default="both", description="the sides on which fronts of houses stand; doors are in them"
    )
    house_m: float = Field(default=10.0, ge=4.0, le=20.0, description="height of the houses")
    sky_c: Celsius = Field(
        default=5.0,
        description="what the sky seems to have at the horizon; overhead it is 15 K colder, and clouds are "
        "warmer",
    )


PlaceSpec = Annotated[
    RoomSpec | CorridorSpec | LCorridorSpec | TCorridorSpec | StreetSpec, Field(discriminator="kind")
]
