"""Schema of a scenario file: every key with its unit, limits, default and description.

Lengths are in metres, angles in degrees, times in seconds, temperatures in degC; keys end in their unit.
x points forward from the start of the place, y to the left; headings are counted from x to the left.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Final, Literal, NamedTuple

from pydantic import Field, TypeAdapter, with_config

from peopleboy.scenarios.files.people import GroupSpec, PersonSpec
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.validation import STRICT
from peopleboy.settings import Seconds, Word
from peopleboy.sim.physics.physics_engine import PhysicsName, default_physics
from peopleboy.sim.places.furniture.thing_config import ThingConfig
from peopleboy.sim.places.place_config import PlaceConfig
from peopleboy.sim.shapes.materials import Detail

CameraFault = Literal[
    "camera_lost", "camera_frozen", "camera_black", "camera_saturated", "camera_shutter", "frames_dropped",
    "frames_late", "frames_duplicated", "dead_rows", "noise_bursts", "calibration_off",
]  # fmt: skip
SonarFault = Literal["sonar_maximum", "sonar_stuck"]
Failure = Literal[
    CameraFault, SonarFault, "wheel_slip", "odometry_jumps", "odometry_drift",
    "tracker_overload", "tracker_raises",
]  # fmt: skip


class Strength(NamedTuple):
    """What the strength of a kind of fault means, its default and its greatest value."""

    meaning: str
    default: float
    greatest: float


STRENGTHS: Final[Mapping[str, Strength]] = {
    "frames_dropped": Strength("share of the frames", 0.5, 1.0),
    "frames_late": Strength("delay [s]", 0.2, 2.0),
    "frames_duplicated": Strength("copies after each frame", 1.0, 15.0),
    "dead_rows": Strength("share of the rows", 0.2, 1.0),
    "noise_bursts": Strength("standard deviation [grey levels]", 60.0, 255.0),
    "calibration_off": Strength("shift to the right [share of the image width]", 0.1, 0.5),
    "wheel_slip": Strength("share of the motion that is lost", 0.3, 0.9),
    "odometry_drift": Strength("excess distance, as a share", 0.2, 1.0),
    "tracker_overload": Strength("frames skipped after each processed one", 2.0, 30.0),
}
"""Kinds of faults that have a strength."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LightSpec:
    """A change of the room's light."""

    at_s: Annotated[Seconds, Field(description="time of the change")]
    level: Annotated[float, Field(ge=0.0, le=2.0, description="0 is dark, 1 is full light")]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultSpec:
    """A temporary failure of a sensor or of the tracker."""

    kind: Annotated[
        Failure,
        Field(
            description="`camera_lost`: a camera gives no signal, its images are zero; `camera_frozen`: it "
            "repeats its last image; `camera_black`: its images are black; `camera_saturated`: white; "
            "`camera_shutter`: it repeats its last image for 0.4 s of every 2 s; `frames_dropped`: single "
            "frames are replaced by the previous one; `frames_late`: images are delayed; "
            "`frames_duplicated`: every image is repeated; `dead_rows`: rows of the image are black; "
            "`noise_bursts`: every other image is noisy; `calibration_off`: the image is shifted sideways; "
            "`sonar_maximum`: sonars report their maximum range; `sonar_stuck`: they repeat their readings; "
            "`wheel_slip`: the robot moves less than its wheels; `odometry_jumps`: the odometry pose "
            "jumps at once, and again every second; `odometry_drift`: the odometry overestimates distances; "
            "`tracker_overload`: the tracker skips frames and repeats its tracks; `tracker_raises`: it "
            "raises an error at every image"
        ),
    ]
    from_s: Annotated[Seconds, Field(description="start of the failure")]
    lasts_s: Annotated[
        Seconds | None, Field(description="duration of the failure; if omitted, until the end of the run")
    ] = None
    camera: Annotated[
        Word | None, Field(description="name of the camera that fails; if omitted, all cameras")
    ] = None
    sonar: Annotated[
        int | None, Field(ge=0, le=15, description="number of the sonar that fails; if omitted, all sonars")
    ] = None
    strength: Annotated[
        float | None,
        Field(
            gt=0.0,
            description="strength; "
            + "; ".join(
                f"of `{kind}` {one.meaning}, default {one.default:g}, at most {one.greatest:g}"
                for kind, one in STRENGTHS.items()
            ),
        ),
    ] = None

    @property
    def chosen_strength(self) -> float:
        """The strength, or its default; NaN for a kind that has none."""
        if self.strength is not None:
            return self.strength
        return STRENGTHS[self.kind].default if self.kind in STRENGTHS else math.nan


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnSpec:
    """Written by a run: the origin of the sampled values."""

    seed: Annotated[int, Field(ge=0, description="seed of the run")]
    versions: Annotated[dict[str, str], Field(description="versions of packages that affect the output")] = (
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

    name: Annotated[Word, Field(description="name of the scenario, one word; also used for folders")]
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
        Field(description="library scenario that supplies the keys omitted in this file"),
    ] = None
    duration_s: Annotated[float, Field(gt=0.0, le=36000.0, description="duration of a run")]
    place: Annotated[PlaceConfig, Field(description="the room, corridor or street")]
    things: Annotated[
        tuple[ThingConfig, ...],
        Field(strict=False, max_length=300, description="objects in the place"),
    ] = ()
    people: Annotated[
        tuple[PersonSpec, ...],
        Field(strict=False, max_length=60, description="people in the place"),
    ] = ()
    groups: Annotated[
        tuple[GroupSpec, ...],
        Field(strict=False, max_length=20, description="groups of people who walk side by side"),
    ] = ()
    clothes_differ: Annotated[
        bool,
        Field(description="whether omitted colours of clothes are sampled to differ clearly"),
    ] = False
    detail: Annotated[
        Detail,
        Field(
            description="level of detail of people and surfaces: `full` is closer to real images, "
            "`plain` is faster and reproduces the images of older files"
        ),
    ] = "plain"
    physics: Annotated[
        PhysicsName,
        Field(
            description="physics of the robot: `bullet` simulates dynamics and needs PyBullet; `kinematic` "
            "rolls without slip, is faster and does not need PyBullet; if omitted, `bullet` if PyBullet is "
            "installed, otherwise `kinematic`",
            json_schema_extra={"default": "bullet"},
        ),
    ] = field(default_factory=default_physics)
    lights: Annotated[
        tuple[LightSpec, ...],
        Field(
            strict=False,
            max_length=1000,
            description="changes of the room's light, in order of time; if omitted, full light",
        ),
    ] = ()
    robot: Annotated[RobotSpec, Field(description="start position, cameras and behaviour of the robot")]
    faults: Annotated[
        tuple[FaultSpec, ...],
        Field(strict=False, max_length=50, description="sensor and tracker failures, to test a controller"),
    ] = ()
    drawn: Annotated[DrawnSpec | None, Field(description="written by a run; do not set it")] = None


def to_data(spec: ScenarioSpec) -> dict[str, Any]:
    """Return a scenario as plain data for a file; keys without a value are left out."""
    data: dict[str, Any] = TypeAdapter(ScenarioSpec).dump_python(
        spec, mode="json", by_alias=True, exclude_none=True
    )
    return data


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of scenario files, for editors; with `like`, required keys may be omitted."""
    schema = TypeAdapter(ScenarioSpec).json_schema()
    for part in schema["$defs"].values():
        # Descriptions are docstrings, whose list of errors says nothing to a writer of files.
        if "description" in part:
            part["description"] = part["description"].partition("\n\nRaises:")[0]
    required = schema.pop("required")
    return schema | {"anyOf": [{"required": required}, {"required": ["name", "description", "like"]}]}
