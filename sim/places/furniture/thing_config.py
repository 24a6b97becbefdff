"""The kinds of things by name, and the settings of a thing: position, appearance and actions."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field

from peopleboy.settings import Celsius, Coordinate, Degrees, Name, Point, Share, Size, Word
from peopleboy.sim.places.furniture import (
    appliances,
    furniture_pieces,
    household_pieces,
    street_pieces,
)
from peopleboy.sim.places.moving import ActionKind
from peopleboy.sim.places.pieces import Kind, kinds_of
from peopleboy.sim.shapes.materials import Colour

# Listings and the schema show the kinds in this order.
_MODULES = (furniture_pieces, household_pieces, appliances, street_pieces)
KINDS: dict[str, Kind] = {
    name: kind for module in _MODULES for name, kind in kinds_of(module.__name__).items()
}


ThingKind = Literal[*KINDS, "urdf"]  # type: ignore[valid-type]
ActionName = Literal[*ActionKind]  # type: ignore[valid-type]


@dataclass(frozen=True, slots=True, kw_only=True)
class PatternConfig:
    """A two-coloured pattern."""

    kind: Annotated[
        Literal["plain", "stripes", "checks", "patch", "speckle"], Field(description="shape of the pattern")
    ]
    period_m: Annotated[
        float,
        Field(ge=0.01, le=10.0, description="width of two stripes or of two checks, or the size of a patch"),
    ] = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionConfig:
    """A movement of an object, either on its own or in the hand of a person."""

    at_s: Annotated[float, Field(le=36000.0, description="start of the action")]
    kind: Annotated[
        ActionName,
        Field(
            description="`appear` and `vanish` take no time. `glide` moves the object to another "
            "position, including up or down. `turn` rotates it about a hinge, like a door. "
            "`slide` moves it forwards or backwards, like a drawer"
        ),
    ]
    to_m: Annotated[
        Point | None,
        Field(description="position after the action; by default, unchanged"),
    ] = None
    base_m: Annotated[
        float | None,
        Field(ge=0.0, le=8.0, description="height of the base after the action; by default, unchanged"),
    ] = None
    facing_deg: Annotated[
        Degrees | None,
        Field(
            description="orientation after the action, reached by the shorter rotation; by default, unchanged"
        ),
    ] = None
    takes_s: Annotated[
        float | None, Field(le=600.0, description="duration of a `glide`, `turn` or `slide`")
    ] = None
    hinge_m: Annotated[
        Point | None,
        Field(description="position of the vertical axis of a `turn`, fixed in the world"),
    ] = None
    by: Annotated[
        Name | None,
        Field(description="name of the person who moves the object; the person must be within reach"),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingConfig:
    """An object on the floor, on another object, or on a wall."""

    kind: Annotated[ThingKind, Field(description="kind of object")]
    name: Annotated[
        Name | None,
        Field(description="name of the object; by default, its kind and a number, such as `radiator_1`"),
    ] = None
    at_m: Annotated[
        Point | None, Field(description="position on the floor; cannot be combined with `wall`")
    ] = None
    wall: Annotated[Word | None, Field(description="wall that the object hangs on or stands against")] = None
    along_m: Annotated[
        Coordinate | None,
        Field(
            description="position along that wall: world x for a north or south wall, world y for an "
            "east or west wall"
        ),
    ] = None
    on_top_of: Annotated[Name | None, Field(description="name of the object that it stands on")] = None
    base_m: Annotated[
        float | None,
        Field(ge=0.0, le=8.0, description="height of the base; the default depends on the kind"),
    ] = None
    facing_deg: Annotated[
        Degrees, Field(description="orientation of the front; an object on a wall faces away from the wall")
    ] = 0.0
    size_m: Annotated[
        Size | None, Field(description="depth, width and height; the default depends on the kind")
    ] = None
    temperature_c: Annotated[
        Celsius | None,
        Field(
            description="temperature of the main surface; the default depends on the kind. Thermal "
            "cameras measure up to 160"
        ),
    ] = None
    emissivity: Annotated[
        float,
        Field(
            gt=0.0,
            le=1.0,
            description="emissivity of the main surface; the surface reflects the surroundings with 1 "
            "minus this value",
        ),
    ] = 0.93
    shine: Annotated[
        Share | None,
        Field(
            description="specular share of the reflection of the main surface, from 0 (dull) to 1 "
            "(glass). It is visible with `detail: full` on flat sides; the default depends on "
            "the kind"
        ),
    ] = None
    colour: Annotated[
        Colour | None, Field(description="colour of the main surface; the default depends on the kind")
    ] = None
    pattern: Annotated[
        PatternConfig, Field(description="pattern of the main surface, visible to the colour camera")
    ] = field(default_factory=lambda: PatternConfig(kind="plain"))
    urdf: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=200,
            description="for kind `urdf`: name of a file in pybullet_data or in the folder of the "
            "scenario file",
        ),
    ] = None
    hidden_at_start: Annotated[
        bool, Field(description="whether the object is absent until an action makes it appear")
    ] = False
    actions: Annotated[
        tuple[ActionConfig, ...],
        Field(
            strict=False,
            max_length=100,
            description="actions of the object, in order of time; they require a `name`",
        ),
    ] = ()
    scale: Annotated[float, Field(ge=0.001, le=1000.0, description="for kind `urdf`: scale factor")] = 1.0
