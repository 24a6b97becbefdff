"""Warm and cold things in the place."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from peopleboy.scenarios.files.schema.values import (
    Celsius,
    Colour,
    Coordinate,
    Degrees,
    Key,
    Name,
    Point,
    Size,
    Strict,
)
from peopleboy.sim.places.furniture.thing_kinds import KINDS
from peopleboy.sim.places.moving import ActionKind


class PatternSpec(Strict):
    """A two-coloured pattern."""

    kind: Literal["plain", "stripes", "checks", "patch", "speckle"] = Field(
        description="shape of the pattern"
    )
    period_m: float = Field(
        default=0.1,
        ge=0.01,
        le=10.0,
        description="width of a pair of stripes, of two checks, or size of a patch",
    )


class ActionSpec(Strict):
    """Something that happens to a thing, alone or by somebody's hand."""

    at_s: float = Field(le=36000.0, description="when it begins")
    kind: Literal[*ActionKind] = Field(  # type: ignore[valid-type]
        description="`appear` and `vanish` at once; `glide` to another place, also up and down; `turn` about "
        "a hinge, as a door; `slide` forth or back along its own front, as a drawer"
    )
    to_m: Point | None = Field(
        default=None, description="where it is then; left out of `appear` and `glide`, where it was"
    )
    base_m: float | None = Field(
        default=None, ge=0.0, le=8.0, description="height of its foot then; left out, as it was"
    )
    facing_deg: Degrees | None = Field(
        default=None, description="where its front looks then, the shorter way round; left out, as it was"
    )
    takes_s: float | None = Field(
        default=None, le=600.0, description="how long a `glide`, `turn` or `slide` lasts"
    )
    hinge_m: Point | None = Field(
        default=None, description="where the upright axis is that it turns about, which does not go along"
    )
    by: Name | None = Field(
        default=None,
        description="name of the person whose hand is at the thing meanwhile, and who must be near enough",
    )


class ThingSpec(Strict):
    """A thing that stands on the floor, on another thing, or on a wall."""

    kind: Literal[*KINDS, "urdf"] = Field(description="what it is")  # type: ignore[valid-type]
    name: Name | None = Field(
        default=None, description="defaults to the kind and a number, such as radiator_1"
    )
    at_m: Point | None = Field(default=None, description="where it stands; not together with wall")
    wall: Key | None = Field(default=None, description="the wall that it hangs on or stands against")
    along_m: Coordinate | None = Field(
        default=None,
        description="where along that wall: world x of north or south walls, world y of east or west walls",
    )
    on_top_of: Name | None = Field(default=None, description="name of the thing that it stands on")
    base_m: float | None = Field(
        default=None, ge=0.0, le=8.0, description="height of its foot, where the kind's own will not do"
    )
    facing_deg: Degrees = Field(
        default=0.0, description="where its front looks; a thing on a wall looks into the place"
    )
    size_m: Size | None = Field(default=None, description="depth, width, height")
    temperature_c: Celsius | None = Field(
        default=None,
        description="of its main surface; left out, the kind's own; thermal cameras read 160 at most",
    )
    emissivity: float = Field(
        default=0.93,
        gt=0.0,
        le=1.0,
        description="of its main surface; what is missing to 1 mirrors the surroundings",
    )
    shine: float | None = Field(
        default=None,
        ge=0.0,
        le=1.0,
        description="how much of what its main surface reflects it mirrors, from 0, dull, to 1, glass; seen "
        "with `detail: full` in flat sides; left out, the kind's own",
    )
    colour: Colour | None = Field(default=None, description="of its main surface; left out, the kind's own")
    pattern: PatternSpec = Field(
        default=PatternSpec(kind="plain"), description="of its main surface, seen by the colour camera"
    )
    urdf: str | None = Field(
        default=None,
        min_length=1,
        max_length=200,
        description="of kind urdf: a file of pybullet_data, or one in the scenario file's own folder",
    )
    hidden_at_start: bool = Field(default=False, description="whether it is not there until it appears")
    actions: tuple[ActionSpec, ...] = Field(
        default=(),
        strict=False,
        max_length=100,
        description="what happens to it, in the order of time; it needs a name",
    )
    scale: float = Field(default=1.0, ge=0.001, le=1000.0, description="factor on the size of a `urdf`")
