"""Every kind of thing by name, and the settings of a thing: where it stands, how it looks, what it does."""

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
        Field(ge=0.01, le=10.0, description="width of a pair of stripes, of two checks, or size of a patch"),
    ] = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionConfig:
    """Something that happens to a thing, alone or by a person's hand."""

    at_s: Annotated[float, Field(le=36000.0, description="when it begins")]
    kind: Annotated[
        ActionName,
        Field(
            description="`appear` and `vanish` at once; `glide` to another place, also up and down; `turn` "
            "about a hinge, as a door; `slide` forth or back along its own front, as a drawer"
        ),
    ]
    to_m: Annotated[
        Point | None,
        Field(description="where it is then; left out of `appear` and `glide`, where it was"),
    ] = None
    base_m: Annotated[
        float | None, Field(ge=0.0, le=8.0, description="height of its foot then; left out, as it was")
    ] = None
    facing_deg: Annotated[
        Degrees | None,
        Field(description="where its front looks then, the shorter way round; left out, as it was"),
    ] = None
    takes_s: Annotated[
        float | None, Field(le=600.0, description="how long a `glide`, `turn` or `slide` lasts")
    ] = None
    hinge_m: Annotated[
        Point | None,
        Field(description="where the upright axis is that it turns about, which does not go along"),
    ] = None
    by: Annotated[
        Name | None,
        Field(
            description="name of the person whose hand is at the thing meanwhile, and who must be near enough"
        ),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingConfig:
    """A thing that stands on the floor, on another thing, or on a wall."""

    kind: Annotated[ThingKind, Field(description="what it is")]
    name: Annotated[
        Name | None, Field(description="defaults to the kind and a number, such as radiator_1")
    ] = None
    at_m: Annotated[Point | None, Field(description="where it stands; not together with wall")] = None
    wall: Annotated[Word | None, Field(description="the wall that it hangs on or stands against")] = None
    along_m: Annotated[
        Coordinate | None,
        Field(
            description="where along that wall: world x of north or south walls, world y of east or west "
            "walls"
        ),
    ] = None
    on_top_of: Annotated[Name | None, Field(description="name of the thing that it stands on")] = None
    base_m: Annotated[
        float | None,
        Field(ge=0.0, le=8.0, description="height of its foot, where the kind's own will not do"),
    ] = None
    facing_deg: Annotated[
        Degrees, Field(description="where its front looks; a thing on a wall looks into the place")
    ] = 0.0
    size_m: Annotated[Size | None, Field(description="depth, width, height")] = None
    temperature_c: Annotated[
        Celsius | None,
        Field(description="of its main surface; left out, the kind's own; thermal cameras read 160 at most"),
    ] = None
    emissivity: Annotated[
        float,
        Field(
            gt=0.0,
            le=1.0,
            description="of its main surface; what is missing to 1 mirrors the surroundings",
        ),
    ] = 0.93
    shine: Annotated[
        Share | None,
        Field(
            description="how much of what its main surface reflects it mirrors, from 0, dull, to 1, glass; "
            "seen with `detail: full` in flat sides; left out, the kind's own"
        ),
    ] = None
    colour: Annotated[Colour | None, Field(description="of its main surface; left out, the kind's own")] = (
        None
    )
    pattern: Annotated[PatternConfig, Field(description="of its main surface, seen by the colour camera")] = (
        field(default_factory=lambda: PatternConfig(kind="plain"))
    )
    urdf: Annotated[
        str | None,
        Field(
            min_length=1,
            max_length=200,
            description="of kind urdf: a file of pybullet_data, or one in the scenario file's own folder",
        ),
    ] = None
    hidden_at_start: Annotated[bool, Field(description="whether it is not there until it appears")] = False
    actions: Annotated[
        tuple[ActionConfig, ...],
        Field(
            strict=False,
            max_length=100,
            description="what happens to it, in the order of time; it needs a name",
        ),
    ] = ()
    scale: Annotated[float, Field(ge=0.001, le=1000.0, description="factor on the size of a `urdf`")] = 1.0
