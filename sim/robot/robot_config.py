"""The settings of the robot: start pose, drive, sonars and cameras."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, TypeVar

from pydantic import Field

from peopleboy.settings import IN_DEGREES, Point, Share
from peopleboy.sim.cameras.camera_config import CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.kinds import check_cameras

# Cameras by name: an immutable mapping keeps frozen settings hashable.

V = TypeVar("V")


class Named(Mapping[str, V]):
    """Immutable mapping of named values, in order; unlike a `MappingProxyType` it can be pickled."""

    __slots__ = ("_values",)

    def __init__(self, values: Mapping[str, V]) -> None:
        self._values = dict(values)

    def __getitem__(self, name: str) -> V:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __hash__(self) -> int:
        return hash(tuple(self._values.items()))

    def __repr__(self) -> str:
        return f"Named({self._values})"


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarConfig:
    """The ring of 16 sonars.

    Positions and angles: ARIA's robot parameter file peoplebot-sh.p, SonarUnit 0..15.
    """

    nearest_m: Annotated[float, Field(ge=0.0, description="shortest distance that a sonar reads")] = 0.15
    farthest_m: Annotated[
        float, Field(gt=0.0, description="longest distance, and the reading without an object in range")
    ] = 5.0
    cone_rad: Annotated[
        float, IN_DEGREES, Field(gt=0.0, le=90.0, description="full opening angle of a sonar's beam")
    ] = math.radians(15.0)
    noise_m: Annotated[float, Field(ge=0.0, description="standard deviation of a reading")] = 0.01
    drop_out: Annotated[Share, Field(description="share of lost readings, which read farthest_m")] = 0.01
    height_m: Annotated[float, Field(ge=0.0, description="height of the ring above the floor")] = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveConfig:
    """Limits of the differential drive, and the noise of its wheel encoders."""

    max_linear_m_s: Annotated[float, Field(ge=0.0, description="forward speed limit")] = 0.8
    max_angular_rad_s: Annotated[float, Field(ge=0.0, description="turn rate limit [rad/s]")] = math.radians(
        150.0
    )
    linear_acceleration_m_s2: Annotated[
        float, Field(gt=0.0, description="rate at which the forward speed changes [m/s2]")
    ] = 0.6
    angular_acceleration_rad_s2: Annotated[
        float, Field(gt=0.0, description="rate at which the turn rate changes [rad/s2]")
    ] = math.radians(200.0)
    # The robot is tall and has its castor at the rear: harder braking lifts its rear. At the end of a stop it
    # has no time to rise: by 0.8 degrees at most, which lets it rest within 0.3 s from its highest speed.
    emergency_m_s2: Annotated[
        float, Field(gt=0.0, description="rate at which the forward speed falls in an emergency stop [m/s2]")
    ] = 2.3
    emergency_end_m_s2: Annotated[
        float, Field(gt=0.0, description="the same at the end of the stop [m/s2]")
    ] = 4.0
    emergency_end_m_s: Annotated[
        float, Field(ge=0.0, description="forward speed below which the end of the stop begins [m/s]")
    ] = 0.3
    emergency_rad_s2: Annotated[
        float, Field(gt=0.0, description="rate at which the turn rate falls in an emergency stop [rad/s2]")
    ] = math.radians(400.0)
    encoder_noise_m: Annotated[
        float,
        Field(
            ge=0.0,
            description="standard deviation of the distance measured by a wheel encoder per 1 m; it grows "
            "with the square root of the distance",
        ),
    ] = 0.002

    @property
    def limits(self) -> tuple[float, float]:
        """[m/s, rad/s] limits of the two speeds."""
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
    """The robot: its start pose, drive and sensors.

    Raises:
        BadInput: cameras have clashing names, or there is no thermal camera.
    """

    at_m: Annotated[Point, Field(description="start position")] = (0.0, 0.0)
    heading_rad: Annotated[
        float, IN_DEGREES, Field(ge=-720.0, le=720.0, description="heading at the start")
    ] = 0.0
    drive: DriveConfig = field(default_factory=DriveConfig)
    sonar: SonarConfig = field(default_factory=SonarConfig)
    # In this order; one of them is the thermal camera `thermal`.
    cameras: Mapping[str, CameraConfig] = field(
        default_factory=lambda: {"thermal": ThermalConfig(), "colour": ColourConfig()}
    )

    def __post_init__(self) -> None:
        """Refuse cameras with clashing names, and make the mapping immutable."""
        check_cameras(self.cameras)
        object.__setattr__(self, "cameras", Named(self.cameras))
