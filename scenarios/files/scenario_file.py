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
from peopleboy.scenarios.files.variation import EpisodeSpec
from peopleboy.settings import Seconds, Word
from peopleboy.sim.people.person_config import BodyShape
from peopleboy.sim.physics.physics_engine import PhysicsName, default_physics
from peopleboy.sim.places.furniture.thing_config import ThingConfig
from peopleboy.sim.places.place_config import PlaceConfig
from peopleboy.sim.shapes.materials import Detail

CameraFault = Literal[
    "camera_lost", "camera_frozen", "camera_black", "camera_saturated", "camera_shutter", "frames_dropped",
    "frames_late", "frames_duplicated", "dead_rows", "noise_bursts", "calibration_off", "calibration_turned",
]  # fmt: skip
SonarFault = Literal["sonar_maximum", "sonar_stuck"]
Failure = Literal[
    CameraFault, SonarFault, "wheel_slip", "odometry_jumps", "odometry_drift", "robot_pushed", "robot_lifted",
    "tracker_overload", "tracker_raises",
]  # fmt: skip


class Strength(NamedTuple):
    """What the strength of a kind of fault means, its default and its greatest value."""

    meaning: str
    default: float
    greatest: float


STRENGTHS: Final[Mapping[str, Strength]] = {
    "frames_dropped": Strength("the share of replaced frames", 0.5, 1.0),
    "frames_late": Strength("the delay [s]", 0.2, 2.0),
    "frames_duplicated": Strength("the number of copies after each frame", 1.0, 15.0),
    "dead_rows": Strength("the share of black rows", 0.2, 1.0),
    "noise_bursts": Strength("the standard deviation of the noise [grey levels]", 60.0, 255.0),
    "calibration_off": Strength("the shift to the right [share of the image width]", 0.1, 0.5),
    "calibration_turned": Strength("the angle by which the camera looks too low [deg]", 3.0, 20.0),
    "wheel_slip": Strength("the share of the motion that is lost", 0.3, 0.9),
    "odometry_drift": Strength("the excess distance, as a share of the true distance", 0.2, 1.0),
    "robot_pushed": Strength("the speed to the left [m/s]", 0.2, 1.0),
    "robot_lifted": Strength("the distance back along the robot's path [m]", 1.5, 20.0),
    "tracker_overload": Strength("the number of frames skipped after each processed frame", 2.0, 30.0),
}
"""Kinds of faults that have a strength."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LightSpec:
    """A change of the room's light."""

    at_s: Annotated[Seconds, Field(description="time of the change")]
    level: Annotated[float, Field(ge=0.0, le=2.0, description="light level: 0 is dark, and 1 is full light")]


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultSpec:
    """A temporary failure of a sensor or of the tracker, or a disturbance of the robot."""

    kind: Annotated[
        Failure,
        Field(
            description="`camera_lost`: the camera gives no signal, and its images are zero; "
            "`camera_frozen`: the camera repeats its last image; `camera_black`: images are "
            "black; `camera_saturated`: images are white; `camera_shutter`: the camera repeats "
            "its last image for 0.4 s of every 2 s; `frames_dropped`: some frames are replaced "
            "by the frame before; `frames_late`: images are delayed; `frames_duplicated`: every "
            "image is repeated; `dead_rows`: rows of the image are black; `noise_bursts`: every "
            "other image is noisy; `calibration_off`: the image is shifted sideways; "
            "`calibration_turned`: the camera looks lower than its calibration says; "
            "`sonar_maximum`: sonars report their maximum range; `sonar_stuck`: sonars repeat "
            "their readings; `wheel_slip`: the robot moves less than its wheels turn; "
            "`odometry_jumps`: the odometry pose jumps immediately, and again every second; "
            "`odometry_drift`: the odometry overestimates distances; `robot_pushed`: the robot is "
            "pushed sideways while it drives; `robot_lifted`: the robot is lifted, put down where "
            "it was before, turned by 90 degrees to the left, and its motors are off during the "
            "fault; `tracker_overload`: the tracker skips frames and repeats its tracks; "
            "`tracker_raises`: the tracker raises an error at every image"
        ),
    ]
    from_s: Annotated[Seconds, Field(description="start of the failure")]
    lasts_s: Annotated[
        Seconds | None, Field(description="duration of the failure; by default, until the end of the run")
    ] = None
    camera: Annotated[
        Word | None, Field(description="name of the camera that fails; by default, all cameras")
    ] = None
    sonar: Annotated[
        int | None, Field(ge=0, le=15, description="number of the sonar that fails; by default, all sonars")
    ] = None
    strength: Annotated[
        float | None,
        Field(
            gt=0.0,
            description="strength of the failure. "
            + " ".join(
                f"For `{kind}`, it is {one.meaning} (default {one.default:g}, at most {one.greatest:g})."
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
    """Origin of the sampled values. Runs write this part."""

    seed: Annotated[int, Field(ge=0, description="seed of the run")]
    versions: Annotated[
        dict[str, str], Field(description="versions of the packages that affect the output")
    ] = field(default_factory=dict)
    drive: Annotated[
        Literal["drive.parquet"] | None,
        Field(
            description="file of recorded commands, in the same folder as this file; the robot repeats "
            "them, whatever its `behaviour` is"
        ),
    ] = None
    episode: Annotated[
        EpisodeSpec | None, Field(description="episode of an environment that the run repeats")
    ] = None


@with_config(STRICT)
@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioSpec:
    """A scenario file has these keys at the top level."""

    name: Annotated[
        Word, Field(description="name of the scenario, as one word; output folders are named after it")
    ]
    description: Annotated[
        str,
        Field(
            min_length=1,
            max_length=1000,
            description="summary in one or two sentences, which `peopleboy list` prints",
        ),
    ]
    like: Annotated[
        Word | None,
        Field(description="library scenario from which this file takes all keys that it omits"),
    ] = None
    duration_s: Annotated[float, Field(gt=0.0, le=36000.0, description="duration of a run")]
    place: Annotated[PlaceConfig, Field(description="room, corridor or street")]
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
        Field(strict=False, max_length=20, description="groups of people who walk abreast"),
    ] = ()
    clothes_differ: Annotated[
        bool,
        Field(description="whether sampled colours of clothes differ clearly between people"),
    ] = False
    detail: Annotated[
        Detail,
        Field(
            description="level of detail of people and surfaces. `full` is closer to real images; "
            "`plain` is faster, and reproduces the images of older scenario files"
        ),
    ] = "plain"
    bodies: Annotated[
        BodyShape | None,
        Field(
            description="shape of people. `skins` are meshes of children, adults and elders, which "
            "pinhole cameras see; panoramic cameras, laser scanners and mirrors see capsules in their place. "
            "By default, `skins` with `detail: full`, and `capsules` with `detail: plain`"
        ),
    ] = None
    physics: Annotated[
        PhysicsName,
        Field(
            description="physics of the robot. `bullet` simulates dynamics and needs PyBullet. "
            "`kinematic` assumes rolling without slip, is faster, and does not need PyBullet. "
            "The default is `bullet` if PyBullet is installed, and `kinematic` otherwise",
            json_schema_extra={"default": "bullet"},
        ),
    ] = field(default_factory=default_physics)
    lights: Annotated[
        tuple[LightSpec, ...],
        Field(
            strict=False,
            max_length=1000,
            description="changes of the light level, in order of time; by default, full light",
        ),
    ] = ()
    robot: Annotated[RobotSpec, Field(description="start position, cameras and behaviour of the robot")]
    faults: Annotated[
        tuple[FaultSpec, ...],
        Field(
            strict=False,
            max_length=50,
            description="failures of sensors or of the tracker, for testing a controller",
        ),
    ] = ()
    drawn: Annotated[
        DrawnSpec | None, Field(description="origin of the sampled values; written by runs, not by you")
    ] = None


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
