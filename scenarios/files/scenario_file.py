"""The whole of a scenario file: every key with its unit, its limits, its default and its meaning.

Lengths in metres, angles in degrees, times in seconds, temperatures in degC: the key's last letters say so.
x points forward from where the place begins, y to the left; headings count from x to the left.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, with_config

from peopleboy.scenarios.files.people import GroupSpec, PersonSpec
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.validation import STRICT
from peopleboy.settings import Seconds, Word
from peopleboy.sim.physics.physics_engine import PhysicsName, default_physics
from peopleboy.sim.places.furniture.thing_config import ThingConfig
from peopleboy.sim.places.place_config import PlaceConfig
from peopleboy.sim.shapes.materials import Detail

Failure = Literal["camera_frozen", "camera_black", "tracker_raises", "sonar_maximum", "odometry_jumps"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LightSpec:
    """Level of the room's light from a time on."""

    at_s: Annotated[Seconds, Field(description="time of the change")]
    level: Annotated[float, Field(ge=0.0, le=2.0, description="0 is dark, 1 is full light")]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultSpec:
    """A temporary failure."""

    kind: Annotated[
        Failure,
        Field(
            description="`camera_frozen`: the cameras give the last images again and again; `camera_black`: "
            "they give black ones; `tracker_raises`: the tracker fails at every image; `sonar_maximum`: all "
            "sonars say that there is nothing; `odometry_jumps`: the odometry's pose jumps at once, and "
            "again every second"
        ),
    ]
    from_s: Annotated[Seconds, Field(description="when it begins")]
    lasts_s: Annotated[Seconds | None, Field(description="if omitted, it lasts to the end")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnSpec:
    """In a run folder: where sampled values come from."""

    seed: Annotated[int, Field(ge=0, description="of the run")]
    versions: Annotated[dict[str, str], Field(description="of the packages on which the bytes depend")] = (
        field(default_factory=dict)
    )
    drive: Annotated[
        Literal["drive.parquet"] | None,
        Field(
            description="commands that the robot repeats, in a file beside this one, whatever its behaviour "
            "is"
        ),
    ] = None


@with_config(STRICT)
@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioSpec:
    """A scenario file."""

    name: Annotated[Word, Field(description="one word, for folders")]
    description: Annotated[
        str,
        Field(
            min_length=1,
            max_length=1000,
            description="what happens, in one or two sentences; `peopleboy list` prints it",
        ),
    ]
    like: Annotated[
        Word | None,
        Field(description="a scenario of the library, whose keys replace those that this file omits"),
    ] = None
    duration_s: Annotated[float, Field(gt=0.0, le=36000.0, description="duration of a run")]
    place: Annotated[PlaceConfig, Field(description="the room or corridor")]
    things: Annotated[
        tuple[ThingConfig, ...],
        Field(strict=False, max_length=300, description="objects in the place"),
    ] = ()
    people: Annotated[
        tuple[PersonSpec, ...],
        Field(strict=False, max_length=60, description="people who walk through the place"),
    ] = ()
    groups: Annotated[
        tuple[GroupSpec, ...],
        Field(strict=False, max_length=20, description="people who walk side by side"),
    ] = ()
    clothes_differ: Annotated[
        bool,
        Field(description="whether omitted colours of clothes are sampled to differ clearly"),
    ] = False
    detail: Annotated[
        Detail,
        Field(
            description="how finely people and surfaces are drawn: `full` is nearer to real images, "
            "`plain` is quicker and keeps the bytes of older files"
        ),
    ] = "plain"
    physics: Annotated[
        PhysicsName,
        Field(
            description="what moves the robot: `bullet` has the dynamics of PyBullet, which must be "
            "installed; `kinematic` lets it roll without slip, needs no PyBullet and is quicker; if omitted, "
            "it is `bullet`, or `kinematic` where PyBullet is not installed",
            json_schema_extra={"default": "bullet"},
        ),
    ] = field(default_factory=default_physics)
    lights: Annotated[
        tuple[LightSpec, ...],
        Field(
            strict=False,
            description="steps of the room's light, in the order of time; if omitted, it is full light",
        ),
    ] = ()
    robot: Annotated[RobotSpec, Field(description="start position and what it does")]
    faults: Annotated[
        tuple[FaultSpec, ...],
        Field(strict=False, max_length=50, description="sensor and tracker failures, to test a controller"),
    ] = ()
    drawn: Annotated[DrawnSpec | None, Field(description="written by a run; do not set it")] = None


def to_data(spec: ScenarioSpec) -> dict[str, Any]:
    """Return a scenario as plain data, as its file may hold it; keys without a value are left out."""
    data: dict[str, Any] = TypeAdapter(ScenarioSpec).dump_python(
        spec, mode="json", by_alias=True, exclude_none=True
    )
    return data


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of scenario files, for editors; one that is `like` another leaves keys out."""
    schema = TypeAdapter(ScenarioSpec).json_schema()
    required = schema.pop("required")
    return schema | {"anyOf": [{"required": required}, {"required": ["name", "description", "like"]}]}
