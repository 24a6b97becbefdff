"""Keys of a scenario file for the robot: its start, its cameras, and its behaviour."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import Field, model_validator

from peopleboy.bad_input import BadInput, found_in
from peopleboy.behaviours.following.follow_person import FollowConfig
from peopleboy.behaviours.make_behaviour import BEHAVIOURS
from peopleboy.scenarios.files.validation import GivenCamera
from peopleboy.settings import Point, Seconds, meaning_of
from peopleboy.sim.cameras.kinds import colour_from_thermal, configure_camera
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world_config import CONTROL_HZ

ORACLE: Final = "truth"
"""Name of the tracker that receives the ground-truth positions."""

# Camera names that would clash with other folders, entities and arrays.
_TAKEN: Final = ("truth", "tracks", "scans", "scene", "body", "sonar", "odometry")
_MOST_PIXELS: Final = 1 << 23  # limit of the trackers' integral images
_MOST_PIXELS_IN_ALL = 2 * _MOST_PIXELS
_MOST_CAMERAS = 32

CameraName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandSpec:
    """A velocity command of a scripted robot, valid from a given time.

    The robot follows commands within the limits of its drive: 0.8 m/s, 150 deg/s, 0.6 m/s2 and 200 deg/s2.
    The safety guard keeps 0.45 m from obstacles detected by sonar, so it can stop a scripted robot in front
    of walls and people.
    """

    from_s: Annotated[Seconds, Field(description="time from which the command is valid")]
    linear_m_s: Annotated[
        float, Field(ge=-2.0, le=2.0, description="forward speed; negative values drive backwards")
    ] = 0.0
    angular_deg_s: Annotated[
        float, Field(ge=-360.0, le=360.0, description="turn rate; positive values turn left")
    ] = 0.0


if TYPE_CHECKING:
    BehaviourName = str
else:
    BehaviourName = Literal[tuple(BEHAVIOURS.shipped)]  # which no type checker can read


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSpec:
    """Start pose, cameras and behaviour of the robot."""

    at_m: Annotated[Point, meaning_of(RobotConfig, "at_m")]
    heading_deg: Annotated[float, meaning_of(RobotConfig, "heading_rad")] = 0.0
    behaviour: Annotated[
        BehaviourName,
        Field(
            description="behaviour that drives the robot: "
            + "; ".join(f"`{name}` {entry.summary}" for name, entry in BEHAVIOURS.shipped.items())
        ),
    ] = "stand"
    commands: Annotated[
        tuple[CommandSpec, ...],
        Field(strict=False, max_length=10000, description="commands of a scripted robot, in order of time"),
    ] = ()
    keep_height: Annotated[
        float | None,
        Field(
            gt=0.05,
            le=1.5,
            description="for a robot that follows people: height of the person in the image at which the "
            "robot stops [image heights]",
        ),
    ] = None
    give_up_s: Annotated[
        Seconds | None,
        Field(
            description="for a robot that follows people: time without the track of its person after which "
            f"it may follow another person, by default {FollowConfig().give_up_s:g} s"
        ),
    ] = None
    walls_by: Annotated[
        Literal["sonar", "image"] | None,
        Field(description="for a robot in corridors: sensor that measures the walls, by default `sonar`"),
    ] = None
    goal_m: Annotated[
        Point | None,
        Field(
            description="place to drive to, which `go_to` needs and your own behaviour gets in "
            "`Percept.goal_m`; the run is scored by whether the robot reaches it"
        ),
    ] = None
    tracker: Annotated[
        str | None,
        Field(
            pattern="^[a-z][a-z0-9_-]*$",
            description="tracker whose tracks the robot uses, by default `detection`; the option "
            "`--tracker` overrides it",
        ),
    ] = None
    cameras: Annotated[
        dict[CameraName, Annotated[dict[str, Any], GivenCamera()]],
        Field(
            description="cameras by name. `thermal` and `colour` always exist; list only the values that "
            "differ from their defaults. Any other name adds a camera"
        ),
    ] = field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _say_where_cameras_are(cls, data: Any) -> Any:
        """Explain where cameras belong if a camera is given next to `cameras`."""
        for name in ("thermal", "colour"):
            if isinstance(data, dict) and name in data:
                raise ValueError(f"{name!r} is a camera: write cameras: {{{name}: {{kind: {name}, ...}}}}")
        return data

    def with_cameras(self, cameras: Mapping[str, Mapping[str, Any]]) -> "RobotSpec":
        """Return the same robot with these cameras added; cameras of the same name are replaced."""
        return replace(self, cameras={**self.cameras, **{name: dict(one) for name, one in cameras.items()}})

    def config(self) -> RobotConfig:
        """Return the robot's settings: the defaults, with the changes given in the file.

        Raises:
            BadInput: cameras clash, or the values of a camera contradict each other.
        """
        usual = RobotConfig()
        own = {}
        for name, given in self.cameras.items():
            with found_in(name):
                own[name] = configure_camera(given, CONTROL_HZ)
        return replace(
            usual,
            at_m=self.at_m,
            heading_rad=math.radians(self.heading_deg),
            cameras={**usual.cameras, **own},
        )


def check_cameras(robot: RobotSpec) -> None:
    """Refuse cameras with reserved names, or with kinds, rates or sizes that trackers cannot use.

    Raises:
        BadInput: a camera is invalid; the error holds the key below `robot.cameras`.
    """
    usual = RobotConfig().cameras
    for name, given in robot.cameras.items():
        with found_in(name):
            if name in _TAKEN:
                raise BadInput("the name is reserved for files of a run; choose another")
            if name in usual and given["kind"] != name:
                raise BadInput(
                    f"must be {name!r}, which the tracker needs; choose another name", key=("kind",)
                )
            if name in usual and given.get("rate_hz", CONTROL_HZ) != CONTROL_HZ:
                raise BadInput(
                    f"must be {CONTROL_HZ}, which the tracker needs; leave it out", key=("rate_hz",)
                )
    cameras = robot.config().cameras
    colour_from_thermal(cameras)
    for name, camera in cameras.items():
        width, height = camera.camera.width, camera.camera.height
        if width * height > _MOST_PIXELS:
            raise BadInput(
                f"{width} x {height} pixels are too many; at most {_MOST_PIXELS} in total", key=(name,)
            )
    total = sum(camera.camera.width * camera.camera.height for camera in cameras.values())
    if len(cameras) > _MOST_CAMERAS or total > _MOST_PIXELS_IN_ALL:
        raise BadInput(
            f"{len(cameras)} cameras with {total} pixels are too many; "
            f"at most {_MOST_CAMERAS} with {_MOST_PIXELS_IN_ALL} in total"
        )
