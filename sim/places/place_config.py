"""The settings of a place: its kind, size, doors and surfaces."""

from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Field

from peopleboy.bad_input import BadInput, Key
from peopleboy.settings import Celsius, Share, Word
from peopleboy.sim.places.floor_plan import Door, FloorPlan, Rectangle
from peopleboy.sim.places.place import Sun
from peopleboy.sim.shapes.materials import Colour
from peopleboy.wording import hint

Length = Annotated[float, Field(ge=1.5, le=100.0)]

_LINTEL_M: Final = 0.1

# Default surface temperatures relative to the air temperature [K].
_FROM_AIR: Final = {"floor_c": -1.0, "ceiling_c": 1.8, "walls_c": 0.5, "surroundings_c": 0.0}


def _follow_air(given: Any) -> Any:
    """Fill in the temperatures that follow the air; invalid values are rejected later."""
    air = given.get("air_c") if isinstance(given, dict) else None
    if not isinstance(air, int | float) or not -40.0 <= air <= 60.0:
        return given
    return {key: air + offset for key, offset in _FROM_AIR.items()} | given


@dataclass(frozen=True, slots=True, kw_only=True)
class Temperatures:
    """Surface temperatures of the place, without its objects."""

    air_c: Annotated[
        Celsius | None,
        Field(
            description="air temperature. Floor, ceiling, walls, surroundings and unheated objects "
            "follow it, unless they have their own temperature. By default, the values below for "
            "air of 21 degC apply"
        ),
    ] = None
    floor_c: Annotated[Celsius, Field(description="temperature of the floor")] = 20.0
    ceiling_c: Annotated[Celsius, Field(description="temperature of the ceiling")] = 22.8
    walls_c: Annotated[
        Celsius, Field(description="temperature of all walls that are not in `single_walls_c`")
    ] = 21.5
    single_walls_c: Annotated[
        dict[Word, Celsius],
        Field(
            max_length=200,
            description="temperatures of individual walls by name, such as an outer wall in winter",
        ),
    ] = field(default_factory=dict)
    surroundings_c: Annotated[
        Celsius,
        Field(description="temperature of the surroundings, which surfaces of low emissivity reflect"),
    ] = 21.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Colours:
    """Colours of the place, without its objects.

    A colour is a name, or linear red, green and blue from 0 to 1.
    """

    floor: Annotated[Colour | None, Field(description="colour of the floor")] = None
    ceiling: Annotated[Colour | None, Field(description="colour of the ceiling")] = None
    walls: Annotated[Colour | None, Field(description="colour of the walls")] = None
    doors: Annotated[Colour | None, Field(description="colour of closed doors")] = None


@dataclass(frozen=True, kw_only=True)
class AnyPlaceConfig:
    """Settings of all places."""

    width_m: Annotated[
        float, Field(ge=1.2, le=60.0, description="width; in L and T corridors, that of both legs")
    ]
    height_m: Annotated[float, Field(ge=2.2, le=8.0, description="height of the ceiling")] = 2.7
    doors: Annotated[
        tuple[Door, ...], Field(strict=False, max_length=100, description="doors in the walls")
    ] = ()
    temperatures: Annotated[
        Temperatures, BeforeValidator(_follow_air), Field(description="surface temperatures")
    ] = field(default_factory=Temperatures)
    colours: Annotated[Colours, Field(description="surface colours")] = field(default_factory=Colours)
    floor_shine: Annotated[
        Share,
        Field(
            description="specular share of the reflection of the floor, from 0 (carpet) to 1 (polished "
            "stone); visible with `detail: full`"
        ),
    ] = 0.3
    sun: Annotated[
        Sun | None, Field(description="sun; by default, none. It is visible with `detail: full` only")
    ] = None


@dataclass(frozen=True, kw_only=True)
class RoomConfig(AnyPlaceConfig):
    """A rectangular room; x is from 0 to `length_m`, y up to half the width on either side."""

    kind: Annotated[Literal["room"], Field(description="a rectangular room")]
    length_m: Annotated[Length, Field(description="length along x")]

    def areas(self) -> FloorPlan:
        """Lay out the floor without doors."""
        return straight_corridor(self.length_m, self.width_m)


@dataclass(frozen=True, kw_only=True)
class CorridorConfig(AnyPlaceConfig):
    """A straight corridor; x is from 0 to `length_m`, y up to half the width on either side."""

    kind: Annotated[Literal["corridor"], Field(description="a straight corridor")]
    length_m: Annotated[Length, Field(description="length along x")]

    def areas(self) -> FloorPlan:
        """Lay out the floor without doors."""
        return straight_corridor(self.length_m, self.width_m)


@dataclass(frozen=True, kw_only=True)
class LCorridorConfig(AnyPlaceConfig):
    """A corridor that starts at x = 0 and runs along x, with a corner at its end."""

    kind: Annotated[Literal["l_corridor"], Field(description="a corridor with a corner")]
    first_m: Annotated[Length, Field(description="length of the first leg, including the corner")]
    second_m: Annotated[Length, Field(description="length of the second leg beyond the side of the first")]
    turn: Annotated[Literal["left", "right"], Field(description="direction of the second leg")] = "left"

    def areas(self) -> FloorPlan:
        """Lay out the floor without doors.

        Raises:
            BadInput: the first leg is too short for its corner.
        """
        _check_longer(self.first_m, "first_m", self.width_m)
        return l_corridor(self.first_m, self.second_m, self.width_m, self.turn)


@dataclass(frozen=True, kw_only=True)
class TCorridorConfig(AnyPlaceConfig):
    """A corridor that starts at x = 0, runs along x, and ends in the middle of a corridor along y."""

    kind: Annotated[Literal["t_corridor"], Field(description="a corridor with a junction at its end")]
    stem_m: Annotated[
        Length, Field(description="length of the corridor along x (the stem), up to the corridor along y")
    ]
    bar_m: Annotated[
        Length, Field(description="length of the corridor along y (the bar), in which the stem ends")
    ]

    def areas(self) -> FloorPlan:
        """Lay out the floor without doors.

        Raises:
            BadInput: the bar is too short for the stem.
        """
        _check_longer(self.bar_m, "bar_m", self.width_m)
        return t_corridor(self.stem_m, self.bar_m, self.width_m)


@dataclass(frozen=True, kw_only=True)
class StreetConfig(AnyPlaceConfig):
    """A road between two pavements; x is from 0 to `length_m`, y up to half the width on either side."""

    kind: Annotated[Literal["street"], Field(description="a street with houses and sky")]
    length_m: Annotated[float, Field(ge=5.0, le=40.0, description="length along x")]
    houses: Annotated[
        Literal["both", "north", "south", "none"],
        Field(description="sides of the street that have houses; doors are in the house fronts"),
    ] = "both"
    house_m: Annotated[float, Field(ge=4.0, le=20.0, description="height of the houses")] = 10.0
    sky_c: Annotated[
        Celsius,
        Field(
            description="apparent temperature of the sky at the horizon; the sky overhead is 15 K "
            "colder, and clouds are warmer"
        ),
    ] = 5.0

    def areas(self) -> FloorPlan:
        """Lay out the floor without doors."""
        return straight_corridor(self.length_m, self.width_m)

    def house_walls(self) -> frozenset[str]:
        """Name the walls that are fronts of houses.

        Raises:
            BadInput: a door is on a side without houses.
        """
        walls = {"both": ("north", "south"), "none": ()}.get(self.houses, (self.houses,))
        for index, door in enumerate(self.doors):
            if door.wall not in walls:
                raise BadInput(
                    f"there is no house on side {door.wall}; houses is {self.houses!r}",
                    key=("doors", index, "wall"),
                )
        return frozenset(walls)


PlaceConfig = Annotated[
    RoomConfig | CorridorConfig | LCorridorConfig | TCorridorConfig | StreetConfig,
    Field(discriminator="kind"),
]


def lay_out(config: PlaceConfig) -> FloorPlan:
    """Lay out the floor of a place, with its doors.

    Raises:
        BadInput: a wall is unknown, or a door does not fit.
    """
    plan = config.areas()
    for index, door in enumerate(config.doors):
        check_wall(plan, ("doors", index, "wall"), door.wall)
        if door.height_m > config.height_m - _LINTEL_M:
            raise BadInput(
                f"{door.height_m:g} is too high; the ceiling is at {config.height_m:g} m "
                f"and a lintel needs {_LINTEL_M:g} m",
                key=("doors", index, "height_m"),
            )
    for name in config.temperatures.single_walls_c:
        check_wall(plan, ("temperatures", "single_walls_c"), name)
    return replace(plan, doors=config.doors)


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


def check_wall(plan: FloorPlan, key: Key, name: str) -> None:
    """Refuse the name of a wall that is not in the plan.

    Raises:
        BadInput: the wall is unknown; with the key and the known walls.
    """
    known = [wall.name for wall in plan.walls()]
    if name not in known:
        raise BadInput(f"unknown wall {name!r}; {hint(name, known)}", key=key)


def _check_longer(length_m: float, key: str, width_m: float) -> None:
    if length_m <= width_m:
        raise BadInput(f"{length_m:g} must be more than the corridor's width of {width_m:g} m", key=(key,))
