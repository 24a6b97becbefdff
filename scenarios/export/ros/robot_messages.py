"""ROS 2 messages of the robot: odometry, sonars, frames as in REP 105, and its description.

Frames: map -> odom -> base_link -> thermal_optical, colour_optical and one for each further camera, for each
sonar and each link, and a frame per person.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.export.ros.image_messages import points_message
from peopleboy.scenarios.export.ros.message_types import (
    BASE,
    MAP,
    ODOM,
    Content,
    Message,
    header,
    heading_quaternion,
    optical,
    pose_with_covariance,
    quaternion,
    transform_between,
    vector,
)
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.geometry.scan_plane import ScanPlane
from peopleboy.sim.physics.urdf import read_links
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, SONAR_POSITION_M, URDF, WHEEL_DISTANCE_M
from peopleboy.sim.robot.robot_config import RobotConfig

_ULTRASOUND: Final = 0  # of sensor_msgs/Range
_ROOT: Final = "base"  # the URDF's root link, called base_link in ROS


class OdometryCovariance:
    """Accumulates the errors of wheel encoders, to first order, without wheel slip.

    Args:
        encoder_noise_m: [m] standard deviation of the distance that a wheel's encoder measures over 1 m.
    """

    def __init__(self, encoder_noise_m: float) -> None:
        self._per_m = encoder_noise_m**2
        self._before: Pose2 | None = None
        self._covariance = np.zeros((3, 3))

    def carry(self, pose: Pose2) -> NDArray[np.float64]:
        """Return the covariance (3, 3) of x, y [m] and heading [rad] at the next pose, zero at the first."""
        if self._before is not None:
            self._covariance = self._carried(self._before, pose)
        self._before = pose
        return self._covariance.copy()

    def _carried(self, before: Pose2, pose: Pose2) -> NDArray[np.float64]:
        turn = math.remainder(pose.heading - before.heading, math.tau)
        cos, sin = math.cos(before.heading + turn / 2.0), math.sin(before.heading + turn / 2.0)
        advance = (pose.x - before.x) * cos + (pose.y - before.y) * sin
        by_pose = np.array([[1.0, 0.0, -advance * sin], [0.0, 1.0, advance * cos], [0.0, 0.0, 1.0]])
        by_motion = np.array([[cos, -advance * sin / 2.0], [sin, advance * cos / 2.0], [0.0, 1.0]])
        of_wheels = np.array([[0.5, 0.5], [-1.0 / WHEEL_DISTANCE_M, 1.0 / WHEEL_DISTANCE_M]])
        ways = advance + np.array([-0.5, 0.5]) * turn * WHEEL_DISTANCE_M
        by_wheels = by_motion @ of_wheels
        carried: NDArray[np.float64] = by_pose @ self._covariance @ by_pose.T
        carried += by_wheels * (self._per_m * np.abs(ways)) @ by_wheels.T
        return carried


class RobotMessages:
    """Converts the robot's state at successive ticks to messages.

    Args:
        robot: configuration of the robot.
    """

    def __init__(self, robot: RobotConfig) -> None:
        self._robot = robot
        self._noise = OdometryCovariance(robot.drive.encoder_noise_m)

    def fixed(self, time_ns: int) -> Iterator[Message]:
        """Yield the static messages: robot description, and poses of cameras, sonars and links."""
        base = header(BASE, time_ns)
        height_m = self._robot.sonar.height_m
        frames = [
            _frame(base, optical(name), camera.camera.robot_from_camera)
            for name, camera in self._robot.cameras.items()
            if not isinstance(camera.camera, ScanPlane)
        ]
        frames += [  # a scan is in a frame with x forward and z up, as in REP 103
            transform_between(base, name, plane.position_m, heading_quaternion(plane.yaw_rad))
            for name, camera in self._robot.cameras.items()
            if isinstance(plane := camera.camera, ScanPlane)
        ]
        frames += [
            transform_between(base, _sonar(k), (x, y, height_m), heading_quaternion(SONAR_ANGLE_RAD[k]))
            for k, (x, y) in enumerate(SONAR_POSITION_M.tolist())
        ]
        frames += _link_frames(base)
        yield "/tf_static", "tf2_msgs/TFMessage", {"transforms": frames}
        yield "/robot_description", "std_msgs/String", {"data": robot_description()}

    def messages(self, tick: Tick, time_ns: int) -> Iterator[Message]:
        """Yield all messages of one tick."""
        odometry, sonar = tick.observation.odometry, self._robot.sonar
        echoes = _echoes(tick.observation.sonar_m, sonar.height_m)
        yield "/sonar", "sensor_msgs/PointCloud2", points_message(header(BASE, time_ns), echoes)
        for k, range_m in enumerate(tick.observation.sonar_m.tolist()):
            reading = {
                "header": header(_sonar(k), time_ns), "radiation_type": _ULTRASOUND,
                "field_of_view": sonar.cone_rad,
                "min_range": sonar.nearest_m, "max_range": sonar.farthest_m, "range": range_m,
                "variance": sonar.noise_m**2,
            }  # fmt: skip
            yield f"/{_sonar(k)}/range", "sensor_msgs/Range", reading
        left, right = tick.observation.wheel_speeds_m_s
        twist = {
            "linear": vector((left + right) / 2.0, 0.0, 0.0),
            "angular": vector(0.0, 0.0, (right - left) / WHEEL_DISTANCE_M),
        }
        content = {
            "header": header(ODOM, time_ns),
            "child_frame_id": BASE,
            "pose": pose_with_covariance(odometry, self._noise.carry(odometry)),
            "twist": {"twist": twist, "covariance": np.zeros(36)},
        }
        yield "/odom", "nav_msgs/Odometry", content
        yield "/tf", "tf2_msgs/TFMessage", {"transforms": _frames(tick, time_ns)}


def robot_description() -> str:
    """Return the URDF of the robot, with its root link renamed to base_link."""
    text = URDF.read_text(encoding="utf-8")
    return text.replace(f'<link name="{_ROOT}">', f'<link name="{BASE}">').replace(
        f'<parent link="{_ROOT}"/>', f'<parent link="{BASE}"/>'
    )


def _link_frames(base: Content) -> list[Content]:
    """Return the transforms of all links but the root, with wheels at rest."""
    _, *links = read_links(URDF)
    return [_frame(base, link.name, link.base_from_link) for link in links]


def _sonar(number: int) -> str:
    """Return the name of a sonar's frame, by its number in the ring from 0 on."""
    return f"sonar_{number:02d}"


def _echoes(sonar_m: NDArray[np.float64], height_m: float) -> Mapping[str, NDArray[np.float64]]:
    """Return the sonar readings, as points on the sonars' axes and as ranges."""
    ahead = np.stack([np.cos(SONAR_ANGLE_RAD), np.sin(SONAR_ANGLE_RAD)], axis=1)
    x, y = (SONAR_POSITION_M + sonar_m[:, None] * ahead).T
    return {"x": x, "y": y, "z": np.full(len(x), height_m), "range": sonar_m}


def _frames(tick: Tick, time_ns: int) -> list[Content]:
    """Return the transforms of odometry, so that the robot has its true pose, and of people."""
    odometry = tick.observation.odometry
    poses = [(MAP, ODOM, drift(tick.truth.robot, odometry)), (ODOM, BASE, odometry)]
    poses += [
        (MAP, f"people/{person.name}", Pose2(*person.position_m, person.heading_rad))
        for person in tick.truth.people
    ]
    return [
        transform_between(
            header(parent, time_ns), child, (pose.x, pose.y, 0.0), heading_quaternion(pose.heading)
        )
        for parent, child, pose in poses
    ]


def _frame(base: Content, name: str, pose: NDArray[np.float64]) -> Content:
    turn = quaternion(Rotation.from_matrix(pose[:3, :3]).as_quat())
    return transform_between(base, name, pose[:3, 3].tolist(), turn)


def drift(true: Pose2, odometry: Pose2) -> Pose2:
    """Return the pose of the odometry frame in the world; composed with odometry it gives the true pose."""
    heading = math.remainder(true.heading - odometry.heading, math.tau)
    cos, sin = math.cos(heading), math.sin(heading)
    return Pose2(
        true.x - cos * odometry.x + sin * odometry.y, true.y - sin * odometry.x - cos * odometry.y, heading
    )
