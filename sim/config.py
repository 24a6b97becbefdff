"""Every setting of a world: what stands in it, who walks through it, and what the robot carries."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Camera
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.places.place import Place

# The colour camera sits 6 cm to the left of the thermal one and sees an angle narrower by 1.2 (T eq. 6.1).
COLOUR_BASELINE_M = 0.06
COLOUR_ZOOM = 1.2


def _colour_camera() -> Camera:
    thermal = Camera()
    x, y, z = thermal.position_m
    half_angle = math.atan(math.tan(thermal.vertical_fov_rad / 2.0) / COLOUR_ZOOM)
    return Camera(vertical_fov_rad=2.0 * half_angle, position_m=(x, y + COLOUR_BASELINE_M, z))


@dataclass(frozen=True, slots=True, kw_only=True)
class ThermalConfig:
    """The thermal camera and its image formation.

    Attributes:
        camera: geometry.
        exposure_s: [s] thermal time constant over which rotation blurs the image.
        blur_px: [px] standard deviation of the optics' point spread.
        netd_k: [K] temporal noise, noise-equivalent temperature difference.
        fixed_pattern_k: [K] standard deviation of the offsets between pixels, constant over a run.
        dead_pixels: share of pixels that read one constant value over a run.
        lowest_c, highest_c: [degC] span of the 8-bit image (T ch. 3).
    """

    camera: Camera = field(default_factory=Camera)
    exposure_s: float = 0.012
    blur_px: float = 0.7
    netd_k: float = 0.08
    fixed_pattern_k: float = 0.03
    dead_pixels: float = 0.0001
    lowest_c: float = 24.0
    highest_c: float = 36.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ColourConfig:
    """The colour camera and its image formation.

    Attributes:
        camera: geometry.
        exposure_s: [s] time over which rotation blurs the image.
        gain: share of full scale that a white surface facing the light has at light level 1.
        read_noise: standard deviation of the noise of a black pixel, share of full scale.
        shot_noise: standard deviation of the noise of a white pixel, share of full scale.
    """

    camera: Camera = field(default_factory=_colour_camera)
    exposure_s: float = 0.015
    gain: float = 0.95
    read_noise: float = 0.004
    shot_noise: float = 0.012


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


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotConfig:
    """The robot: where it starts and what it carries.

    Attributes:
        at_m: [m] start on the floor, world frame.
        heading_rad: [rad] start heading, 0 along x, positive to the left.
    """

    at_m: tuple[float, float] = (0.0, 0.0)
    heading_rad: float = 0.0
    drive: DriveConfig = field(default_factory=DriveConfig)
    sonar: SonarConfig = field(default_factory=SonarConfig)
    thermal: ThermalConfig = field(default_factory=ThermalConfig)
    colour: ColourConfig = field(default_factory=ColourConfig)


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldConfig:
    """A whole world, ready to be built.

    Attributes:
        place: walls, floor and things.
        people: who walks through it.
        robot: the robot and its sensors.
        seed: of every random stream in the world.
        physics_hz: [Hz] steps of the physics engine.
        control_hz: [Hz] commands and images.
        renderer: "raycast" or "bullet"; "none" for a world without images, which is several times faster.

    Raises:
        BadInput: a control step is not a whole number of physics steps, or the seed is negative.
    """

    place: Place
    people: tuple[PersonConfig, ...] = ()
    robot: RobotConfig = field(default_factory=RobotConfig)
    seed: int = 0
    physics_hz: int = 240
    control_hz: int = 15
    renderer: str = "raycast"

    def __post_init__(self) -> None:
        """Refuse rates that do not divide, and seeds that are none."""
        if self.control_hz <= 0 or self.physics_hz % self.control_hz:
            raise BadInput(
                f"control rate {self.control_hz} Hz must divide the physics rate {self.physics_hz} Hz: "
                "a control step is a whole number of physics steps"
            )
        if self.seed < 0:
            raise BadInput(f"seed {self.seed} must be 0 or more")
