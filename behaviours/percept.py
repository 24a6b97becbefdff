"""Input of a behaviour at one instant: people in the image, sonar ranges, odometry, and the goal."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2

Ranges = NDArray[np.float64]
Points = NDArray[np.float64]  # (N, 2) [m] x forward, y left, in the robot frame


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenPerson:
    """One tracked person in the thermal image.

    Attributes:
        id: track id, constant for a person.
        x: [half image widths] column of the body's middle, -1 at the left border, +1 at the right one.
        height: [image heights] apparent height from head to feet; above 1 only a part is visible.
        top, bottom: [image heights] rows of head and feet, 0 at the upper border, 1 at the lower one.
        confidence: 0..1, that this is a person.
        is_visible: whether the track is based on this image, and not on a prediction.
        position_m: [m] x forward, y left in the robot frame; None if unknown.
        velocity_m_s: [m/s] relative to the floor, along the same axes; None if unknown.
    """

    id: int
    x: float
    height: float
    top: float
    bottom: float
    confidence: float
    is_visible: bool
    position_m: tuple[float, float] | None = None
    velocity_m_s: tuple[float, float] | None = None

    @property
    def is_sound(self) -> bool:
        """Whether all numbers are finite and the height is positive."""
        numbers = (self.x, self.height, self.top, self.bottom, self.confidence)
        return all(map(math.isfinite, numbers)) and self.height > 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Percept:
    """Input of a behaviour at one control step.

    Attributes:
        time_s: [s] time of the image.
        people: the tracker's people.
        sonar_m: (N,) [m] range in front of each sonar.
        sonar_angle_rad: (N,) [rad] direction of each sonar in the robot frame, positive to the left.
        linear_m_s: [m/s] forward speed from the wheels.
        angular_rad_s: [rad/s] turn rate from the wheels, positive to the left.
        odometry: pose of the robot integrated from the wheels. Its frame is that of the place, and drifts.
        goal_m: [m] x, y of the robot's goal in the frame of `odometry`; None without a goal.
        images: new images by camera name, such as `colour`, (H, W, 3) uint8 sRGB; may be rendered on demand.
        image_age_s: [s] age of the newest image; `people` are those of that image.
        fault: why people cannot be detected now, such as a tracker's error; empty if all is well.

    Raises:
        BadInput: numbers of angles and ranges differ.
    """

    time_s: float
    people: tuple[SeenPerson, ...]
    sonar_m: Ranges
    sonar_angle_rad: Ranges
    linear_m_s: float
    angular_rad_s: float
    odometry: Pose2 = field(default_factory=Pose2)
    goal_m: tuple[float, float] | None = None
    images: Mapping[str, NDArray[np.uint8]] = field(default_factory=dict)
    image_age_s: float = 0.0
    fault: str = ""

    def __post_init__(self) -> None:
        """Store read-only copies of the arrays."""
        for name in ("sonar_m", "sonar_angle_rad"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.sonar_m.ndim != 1 or self.sonar_m.shape != self.sonar_angle_rad.shape:
            raise BadInput(
                f"sonar ranges and angles must be two (N,) arrays, "
                f"got {self.sonar_m.shape} and {self.sonar_angle_rad.shape}"
            )

    @property
    def is_sound(self) -> bool:
        """Whether time, speeds and pose are finite and there is at least one sonar."""
        pose = (self.odometry.x, self.odometry.y, self.odometry.heading)
        numbers = (self.time_s, self.linear_m_s, self.angular_rad_s, *pose)
        return all(map(math.isfinite, numbers)) and self.sonar_m.size > 0
