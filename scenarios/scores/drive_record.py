"""Record a drive among people, the input of its scores, and declare the metrics of scores."""

import math
from array import array
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.truth.events import CONTACT_ENDS_S
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth

TARGET = 1  # the person to follow: the scenario's first

_STILL_M: Final = 0.05  # a robot with its motors off stays within this, also if it is bumped into by physics
_STILL_RAD: Final = 0.05

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DriveRecord:
    """The data of a run that its scores need; one row per frame.

    Attributes:
        time_s: (T,) [s] rising.
        robot: (T, 3) [m, m, rad] x, y, heading in the world frame.
        speed_m_s: (T,) of the robot, forwards.
        is_contact: (T,) whether the robot touched an object or a person.
        target: (T, 2) [m] x, y of the person to follow, NaN while the person is absent.
        track: (T,) number of the track on this person, 0 for none.
        is_wrong: (T,) whether the robot followed another person; None if unknown.
        count: (T,) number of people present.
        people: (Q, 4) [m, m, m/s, m/s] x, y and velocity of all of them, one frame after the other.

    Raises:
        BadInput: the arrays do not have these shapes, or time does not increase.
    """

    time_s: Floats
    robot: Floats
    speed_m_s: Floats
    is_contact: Flags
    target: Floats
    track: NDArray[np.int64]
    is_wrong: Flags | None
    count: NDArray[np.int64]
    people: Floats

    def __post_init__(self) -> None:
        """Check that the shapes of the arrays match, and that time increases."""
        frames, one = len(self.time_s), (len(self.time_s),)
        wrong = one if self.is_wrong is None else self.is_wrong.shape
        arrays = (self.time_s, self.speed_m_s, self.is_contact, self.track, self.count)
        shapes = [*(a.shape for a in arrays), wrong, self.robot.shape, self.target.shape, self.people.shape]
        if frames == 0 or shapes != [*[one] * 6, (frames, 3), (frames, 2), (self.count.sum(), 4)]:
            raise BadInput(
                "drive: shapes of time, speed, contact, track, count and is_wrong must be (T,), of robot "
                f"(T, 3), target (T, 2), people (Q, 4), with T > 0 and Q the sum of count, got {shapes}"
            )
        if not np.all(np.diff(self.time_s) > 0.0):
            raise BadInput("drive: time_s must increase from frame to frame")

    @property
    def has_moved(self) -> bool:
        """Whether the robot left its place, or turned."""
        moved = np.abs(self.robot - self.robot[0]).max(axis=0)
        return bool(moved[:2].max() > _STILL_M or moved[2] > _STILL_RAD)

    @property
    def is_tracked(self) -> Flags:
        """Whether a track was on the person to follow (T,)."""
        return self.track > 0


class DriveLog:
    """Collects the data of a `DriveRecord` instant by instant."""

    def __init__(self) -> None:
        self._rows = array("d")  # 8 bytes a number, in runs of hours
        self._people = array("d")

    def add(self, truth: Truth | ImageFreeTruth, track: int, is_wrong: bool | None = None) -> None:
        """Add one instant.

        Args:
            truth: ground truth of the instant.
            track: number of the track on the person to follow, 0 for none.
            is_wrong: whether the robot follows another person; None if unknown.
        """
        robot, (speed_m_s, _), people = truth.robot, truth.robot_velocity, truth.people
        target = next((person.position_m for person in people if person.id == TARGET), (math.nan, math.nan))
        wrong = math.nan if is_wrong is None else float(is_wrong)
        pose = (robot.x, robot.y, robot.heading)
        events = (bool(truth.contacts), track, wrong, len(people))
        self._rows.extend((truth.time_s, *pose, speed_m_s, *target, *events))
        for person in people:
            self._people.extend((*person.position_m, *person.velocity_m_s))

    def record(self) -> DriveRecord:
        """Return the record of all instants so far."""
        table = np.array(self._rows, np.float64).reshape(-1, 11)
        wrong = table[:, 9]
        return DriveRecord(
            time_s=table[:, 0],
            robot=table[:, 1:4],
            speed_m_s=table[:, 4],
            target=table[:, 5:7],
            is_contact=table[:, 7] > 0.0,
            track=table[:, 8].astype(np.int64),
            is_wrong=None if np.isnan(wrong).any() else wrong > 0.0,
            count=table[:, 10].astype(np.int64),
            people=np.array(self._people, np.float64).reshape(-1, 4),
        )


def count_contacts(time_s: Floats, is_contact: Flags) -> int:
    """Count the contacts of a run; bouncing, or rubbing along a wall, is one contact.

    Args:
        time_s: (T,) [s] times of the frames.
        is_contact: (T,) whether the robot touched an object or a person in each frame.
    """
    touches = np.flatnonzero(is_contact)
    is_apart = time_s[touches[1:] - 1] - time_s[touches[:-1]] >= CONTACT_ENDS_S
    return min(len(touches), 1) + int(is_apart.sum())


def mean(values: Floats | Flags) -> float:
    """Return the mean of values (N,); NaN without values."""
    return float(np.mean(values)) if values.size else math.nan


def root_mean_square(values: Floats) -> float:
    """Return the root mean square of values (N,); NaN without values."""
    return math.sqrt(mean(values**2))


def way_m(robot: Floats) -> float:
    """Return the length [m] of a path (T, 2 or more), whose first columns are x and y."""
    return float(np.sum(np.hypot(*np.diff(robot[:, :2], axis=0).T)))


Row = tuple[str, float, str, str]  # name, value, unit, explanation

# Records have shares and radians, tables percent and degrees.
_IN_UNIT: Final[Mapping[str, float]] = {"%": 100.0, "deg": math.degrees(1.0)}


@dataclass(frozen=True, slots=True)
class Metric:
    """Name, unit and meaning of a metric in tables."""

    name: str
    unit: str
    meaning: str

    @property
    def label(self) -> str:
        """Name with unit."""
        return f"{self.name}, {self.unit}" if self.unit else self.name

    @property
    def factor(self) -> float:
        """Value in the unit of tables per value in a record."""
        return _IN_UNIT.get(self.unit, 1.0)


def metric(name: str, unit: str, meaning: str) -> Any:
    """Declare a metric as a field of a `ScoreRecord`."""
    return field(metadata={"metric": Metric(name, unit, meaning)})


class ScoreRecord:
    """A dataclass whose fields are all declared by `metric`; NaN means undefined."""

    __slots__ = ()

    @classmethod
    def metrics(cls) -> dict[str, Metric]:
        """Return the metrics by their key in metrics.json."""
        return {one.name: one.metadata["metric"] for one in fields(cls)}  # type: ignore[arg-type]

    def rows(self) -> list[Row]:
        """Return the metrics as table rows: name, value, unit, explanation."""
        return [
            (one.name, one.factor * getattr(self, key), one.unit, one.meaning)
            for key, one in self.metrics().items()
        ]

    def to_json(self) -> dict[str, Any]:
        """Return the metrics for JSON, with None for undefined values."""
        figures: dict[str, Any] = asdict(self)  # type: ignore[call-overload]
        return {
            key: None if isinstance(value, float) and math.isnan(value) else value
            for key, value in figures.items()
        }
