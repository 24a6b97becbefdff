"""The robot: differential drive, wheel encoders, and a ring of sonars."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.random_streams import stream
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.geometry.vectors import remainder
from peopleboy.sim.physics.physics_engine import Physics
from peopleboy.sim.robot.robot_body import (
    NAME,
    URDF,
    WHEEL_DISTANCE_M,
    WHEEL_RADIUS_M,
    outline_gap,
    wheel_speeds,
)
from peopleboy.sim.robot.robot_config import DriveConfig, RobotConfig
from peopleboy.sim.robot.sonar import SonarRing
from peopleboy.sim.shapes.shapes import Quaternion, Vector

_JOINTS = ("left_wheel_joint", "right_wheel_joint")
_MOTOR_TORQUE_NM = 4.0


def limit_command(linear: float, angular: float, limits: DriveConfig) -> tuple[float, float]:
    """Clip a velocity command [m/s, rad/s] to the robot's limits."""
    return (
        min(max(linear, -limits.max_linear_m_s), limits.max_linear_m_s),
        min(max(angular, -limits.max_angular_rad_s), limits.max_angular_rad_s),
    )


class Gears(NamedTuple):
    """State of a robot's drive; with a leading axis of worlds, of many robots.

    Attributes:
        command, target: (2,) [m/s, rad/s] current and target speeds.
        rise: (2,) [m/s2, rad/s2] rates at which they approach the target.
        turned: (2,) [rad] wheel angles at the last odometry update.
        odometry: (3,) x, y [m], heading [rad].
    """

    command: NDArray[np.float64]
    target: NDArray[np.float64]
    rise: NDArray[np.float64]
    turned: NDArray[np.float64]
    odometry: NDArray[np.float64]


class PeopleBot:
    """A differential-drive robot moved by its wheels alone.

    Its wheels turn at controlled speeds and its acceleration is limited; grip, bumps and walls are simulated
    by the physics engine. Odometry integrates the noisy encoder counts from the start pose.

    Attributes:
        gears: state of its drive.
        limits: its limits of speed and acceleration.
        ring: its sonars.
    """

    def __init__(self, physics: Physics, config: RobotConfig, seed: int) -> None:
        self._physics = physics
        self.limits = config.drive
        self._encoder_noise = stream(seed, "odometry.noise")
        x, y = config.at_m
        self.gears = Gears(
            command=np.zeros(2), target=np.zeros(2), rise=np.array(self.limits.rise), turned=np.zeros(2),
            odometry=np.array([x, y, config.heading_rad]),
        )  # fmt: skip
        self._is_emergency = False
        position, orientation = _place(Pose2(x, y, config.heading_rad))
        physics.add_urdf(NAME, URDF, position=position, orientation=orientation, fixed=False)
        self._turn_wheels()
        self.ring = SonarRing(physics, config.sonar, stream(seed, "sonar.noise"), NAME)
        self.gears.turned[:] = self._wheel_angles()

    def command(self, linear: float, angular: float, *, is_emergency: bool = False) -> None:
        """Set the target velocity [m/s, rad/s], clipped to the robot's limits; acceleration is limited.

        In an emergency the speeds fall at higher rates.

        Raises:
            BadInput: the command is not finite.
        """
        if not (math.isfinite(linear) and math.isfinite(angular)):
            raise BadInput(f"velocity command ({linear}, {angular}) must be finite")
        limits, gears = self.limits, self.gears
        gears.target[:] = limit_command(linear, angular, limits)
        gears.rise[:] = limits.emergency_rise if is_emergency else limits.rise
        self._is_emergency = is_emergency

    def drive(self, dt_s: float) -> None:
        """Move the wheel speeds towards the command, as far as the acceleration limits allow in dt_s."""
        if self._is_emergency and abs(self.gears.command[0]) <= self.limits.emergency_end_m_s:
            self.gears.rise[0] = self.limits.emergency_end_m_s2
        if approach_target(self.gears, dt_s):
            self._turn_wheels()

    def push(self, ahead_m: float, left_m: float) -> None:
        """Shift the robot, which keeps its speed; its wheels do not turn, so the odometry does not notice."""
        to = self.pose().compose(Pose2(ahead_m, left_m))
        self._physics.shift(NAME, (to.x - self.pose().x, to.y - self.pose().y, 0.0))

    def put(self, pose: Pose2) -> None:
        """Put the robot at a pose on the floor, at rest; the odometry does not notice."""
        self._physics.set_pose(NAME, *_place(pose))
        self.gears.command[:] = 0.0
        self._turn_wheels()

    def update_odometry(self) -> None:
        """Integrate the noisy counts of the wheel encoders since the last call."""
        noise = np.empty(2)
        self.draw_noise(noise)
        count_travel(self.gears, self._wheel_angles(), noise * self.limits.encoder_noise_m)

    def draw_noise(self, noise: NDArray[np.float64]) -> None:
        """Fill (2,) with standard normal noise for the encoders in the next control step."""
        self._encoder_noise.standard_normal(out=noise)

    def rebind(self, gears: Gears) -> None:
        """Use other arrays for the state from now on; they must hold the same values already."""
        self.gears = gears

    @property
    def odometry(self) -> Pose2:
        """Pose integrated from the wheel encoders, world frame, exact at the start."""
        return Pose2(*self.gears.odometry.tolist())

    def sonar(self) -> NDArray[np.float64]:
        """Read the ring once: (16,) [m]."""
        return self.ring.read(self.world_from_robot())

    def wheel_speeds(self) -> tuple[float, float]:
        """Measured rim speeds [m/s] of the left and the right wheel."""
        _, speeds = self._physics.joint_states(NAME, _JOINTS)
        return float(speeds[0] * WHEEL_RADIUS_M), float(speeds[1] * WHEEL_RADIUS_M)

    def world_from_robot(self) -> Matrix:
        """(4, 4) true pose of the robot's frame."""
        return self._physics.pose(NAME)

    def pose(self) -> Pose2:
        """Return the true pose on the floor."""
        matrix = self.world_from_robot()
        return Pose2(float(matrix[0, 3]), float(matrix[1, 3]), math.atan2(matrix[1, 0], matrix[0, 0]))

    def gap_to(self, x: float, y: float) -> float:
        """Return the distance [m] on the floor between its outline and a point, world frame; 0 inside."""
        return outline_gap(self.pose(), (x, y))

    def velocity(self) -> tuple[float, float]:
        """Return the true forward speed [m/s] and turn rate [rad/s]."""
        linear, angular = self._physics.velocity(NAME)
        return float(linear @ self.world_from_robot()[:3, 0]), float(angular[2])

    def touching(self) -> set[str]:
        """Names of the bodies that the robot touched during the last physics step, the floor included."""
        return self._physics.touching(NAME)

    def _turn_wheels(self) -> None:
        """Set the motor speeds for the current command."""
        speeds = [speed / WHEEL_RADIUS_M for speed in wheel_speeds(*self.gears.command.tolist())]
        self._physics.set_joint_speeds(NAME, dict(zip(_JOINTS, speeds, strict=True)), _MOTOR_TORQUE_NM)

    def _wheel_angles(self) -> NDArray[np.float64]:
        angles, _ = self._physics.joint_states(NAME, _JOINTS)
        return angles


def _place(pose: Pose2) -> tuple[Vector, Quaternion]:
    """Return the position and orientation of a body that stands on the floor."""
    half = pose.heading / 2.0
    return (pose.x, pose.y, 0.0), (0.0, 0.0, math.sin(half), math.cos(half))


@njit(cache=True, nogil=True)
def approach_target(gears: Gears, dt_s: float) -> bool:
    """Move the speeds of one robot towards their targets, and return whether they have changed."""
    command, target, rise = gears.command, gears.target, gears.rise
    if command[0] == target[0] and command[1] == target[1]:
        return False
    for k in range(2):
        step = rise[k] * dt_s
        command[k] += min(max(target[k] - command[k], -step), step)
    return True


@njit(cache=True, nogil=True)
def count_travel(gears: Gears, angles: NDArray[np.float64], noise_m: NDArray[np.float64]) -> None:
    """Integrate the odometry of one robot.

    Args:
        gears: state of the robot's drive.
        angles: (2,) [rad] current angles of its wheels.
        noise_m: (2,) [m/sqrt(m)] noise of its encoders.
    """
    rims = np.empty(2)
    for k in range(2):
        travelled = (angles[k] - gears.turned[k]) * WHEEL_RADIUS_M
        rims[k] = travelled + noise_m[k] * math.sqrt(abs(travelled))
        gears.turned[k] = angles[k]
    turn, advance = (rims[1] - rims[0]) / WHEEL_DISTANCE_M, (rims[0] + rims[1]) / 2.0
    odometry = gears.odometry
    middle = odometry[2] + turn / 2.0
    odometry[0] += advance * math.cos(middle)
    odometry[1] += advance * math.sin(middle)
    odometry[2] = remainder(odometry[2] + turn)
