"""The settings of the robot: its start, its drive, its sonars, and the cameras that it carries."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from peopleboy.sim.cameras.camera_config import CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import check_cameras
from peopleboy.sim.named import Named


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarConfig:
    """The ring of 16 sonars.

    Positions and angles: ARIA's robot parameter file peoplebot-sh.p, SonarUnit 0..15.

    Attributes:
        nearest_m, farthest_m: [m] range; nothing within it reads farthest_m.
        cone_rad: [rad] full opening angle of a sonar's beam.
        noise_m: [m] standard deviation of a reading.
        drop_out: share of readings that are lost and read farthest_m.
        height_m: [m] of the ring above the floor.
    """

    nearest_m: float = 0.15
    farthest_m: float = 5.0
    cone_rad: float = math.radians(15.0)
    noise_m: float = 0.01
    drop_out: float = 0.01
    height_m: float = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveConfig:
    """Limits of the differential drive, and the noise of its wheel encoders.

    Attributes:
        max_linear_m_s: [m/s] forward speed limit.
        max_angular_rad_s: [rad/s] turn rate limit.
        linear_acceleration_m_s2: [m/s2] rate at which the forward speed changes.
        angular_acceleration_rad_s2: [rad/s2] rate at which the turn rate changes.
        emergency_m_s2, emergency_rad_s2: [m/s2], [rad/s2] rates at which the speeds fall in an emergency
            stop; the robot, which is tall and has its castor behind, lifts its tail when it brakes harder.
        encoder_noise_m: [m] standard deviation of the way that a wheel's encoder counts on 1 m; it grows with
            the square root of the way.
    """

    max_linear_m_s: float = 0.8
    max_angular_rad_s: float = math.radians(150.0)
    linear_acceleration_m_s2: float = 0.6
    angular_acceleration_rad_s2: float = math.radians(200.0)
    emergency_m_s2: float = 2.2
    emergency_rad_s2: float = math.radians(400.0)
    encoder_noise_m: float = 0.002

    @property
    def limits(self) -> tuple[float, float]:
        """[m/s, rad/s] of the two speeds."""
        return self.max_linear_m_s, self.max_angular_rad_s

    @property
    def rise(self) -> tuple[float, float]:
        """[m/s2, rad/s2] rates at which the two speeds change."""
        return self.linear_acceleration_m_s2, self.angular_acceleration_rad_s2

    @property
    def emergency_rise(self) -> tuple[float, float]:
        """[m/s2, rad/s2] the same in an emergency."""
        return self.emergency_m_s2, self.emergency_rad_s2


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotConfig:
    """The robot: where it starts and what it carries.

    Attributes:
        at_m: [m] start on the floor, world frame.
        heading_rad: [rad] start heading, 0 along x, positive to the left.
        cameras: by name, in their order; one of them is the thermal camera `thermal`.

    Raises:
        BadInput: the cameras cannot be told apart, or there is no thermal one.
    """

    at_m: tuple[float, float] = (0.0, 0.0)
    heading_rad: float = 0.0
    drive: DriveConfig = field(default_factory=DriveConfig)
    sonar: SonarConfig = field(default_factory=SonarConfig)
    cameras: Mapping[str, CameraConfig] = field(
        default_factory=lambda: {"thermal": ThermalConfig(), "colour": ColourConfig()}
    )

    def __post_init__(self) -> None:
        """Refuse cameras that clash, and keep them from being changed."""
        check_cameras(self.cameras)
        object.__setattr__(self, "cameras", Named(self.cameras))
