"""ROS 2 messages of one tick: images, cameras, truth, tracks, sonars, odometry and frames.

Frames as in REP 105: map -> odom -> base_link -> thermal_optical, colour_optical and one for each further
camera; a frame per person, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from scipy.spatial.transform import Rotation

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.drawing.overlay import encode_jpeg
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.truth_files import further_cameras
from peopleboy.sim.cameras.camera_config import DepthConfig, ThermalConfig
from peopleboy.sim.cameras.depth import points_of
from peopleboy.sim.cameras.thermal import encode_16bit
from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, SONAR_POSITION_M, WHEEL_DISTANCE_M
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.truth import Box, Truth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import FloorPlace, Status, Track, confirmed


class OdometryCovariance:
    """Adds up what encoders miscount, to first order; slip of the wheels is none of it.

    Args:
        encoder_noise_m: [m] standard deviation of the way that a wheel's encoder counts on 1 m.
    """

    def __init__(self, encoder_noise_m: float) -> None:
        self._per_m = encoder_noise_m**2
        self._before: Pose2 | None = None
        self._covariance = np.zeros((3, 3))

    def carry(self, pose: Pose2) -> NDArray[np.float64]:
        """Give the covariance (3, 3) of x, y [m] and heading [rad] at the next pose; at the first it is 0."""
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


Message = tuple[str, str, Any]  # topic, type, content

JPEG_QUALITY: Final = 90
_POINT_EVERY = 4
_FLOAT32 = 7  # of sensor_msgs/PointField
_PLANE = np.ix_((0, 1, 5), (0, 1, 5))  # x, y and the turn about z of a covariance in space
_MAP, _ODOM, _BASE = "map", "odom", "base_link"

# vision_msgs 4, which no ROS distribution ships with its base.
_VISION: Final = {
    "Point2D": "float64 x\nfloat64 y",
    "Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
    "BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "ObjectHypothesis": "string class_id\nfloat64 score",
    "ObjectHypothesisWithPose": (
        "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nstring id"
    ),
    "Detection2DArray": "std_msgs/Header header\nvision_msgs/Detection2D[] detections",
    "BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
    "Detection3D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox3D bbox\nstring id"
    ),
    "Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections",
}


def message_types() -> Typestore:
    """Give all message types in use."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in _VISION.items():
        store.register(get_types_from_msg(text, f"vision_msgs/msg/{name}"))
    return store


class RosMessages:
    """Turns ticks, in their order, into messages.

    Args:
        robot: whose cameras they are.
        types: from `message_types`.
    """

    def __init__(self, robot: RobotConfig, types: Typestore) -> None:
        self._types = types.types
        self._cameras = robot.cameras
        self._sonar_height_m = robot.sonar.height_m
        self._further = further_cameras(robot.cameras)
        self._noise = OdometryCovariance(robot.drive.encoder_noise_m)

    def fixed(self, time_s: float) -> Iterator[Message]:
        """Say once where the cameras are on the robot."""
        poses = [self._camera_pose(name, camera.camera, time_s) for name, camera in self._cameras.items()]
        yield "/tf_static", "tf2_msgs/msg/TFMessage", self._make("tf2_msgs/TFMessage", transforms=poses)

    def tick(self, tick: Tick) -> Iterator[Message]:
        """Say all about one tick."""
        images, time_s = tick.observation.images, tick.observation.time_s
        due = {name: camera for name, camera in self._cameras.items() if name in images}
        for name, config in due.items():
            if isinstance(config, DepthConfig):
                yield from self._depth_images(name, config, images, time_s)
            else:
                yield self._image(name, images[name], time_s)
            if isinstance(config, ThermalConfig):
                yield self._raw_thermal(name, images[f"{name}_c"], time_s)
        for name, config in due.items():
            if isinstance(config.camera, Pinhole):  # the message knows no other geometry
                content = self._camera_info(name, config.camera, time_s)
                yield f"/{name}/camera_info", "sensor_msgs/msg/CameraInfo", content
        yield self._detections("/truth/people", _people(tick.truth), time_s)
        for name in (name for name in self._further if name in tick.truths):
            yield self._detections(f"/truth/{name}/people", _people(tick.truths[name]), time_s, name)
        for name in due:
            tracks = [(str(t.id), box, t.confidence) for t, box in confirmed(tick.tracks, name)]
            if name == THERMAL:
                yield self._detections("/tracks", tracks, time_s)
            elif tracks:
                yield self._detections(f"/tracks/{name}", tracks, time_s, name)
        yield self._places(tick.tracks, time_s)
        yield self._echoes(tick.observation.sonar_m, time_s)
        yield "/odom", "nav_msgs/msg/Odometry", self._odometry(tick)
        yield "/tf", "tf2_msgs/msg/TFMessage", self._make("tf2_msgs/TFMessage", transforms=self._frames(tick))

    def _make(self, kind: str, **fields: Any) -> Any:
        package, name = kind.split("/")
        return self._types[f"{package}/msg/{name}"](**fields)

    def _header(self, frame: str, time_s: float) -> Any:
        sec, nanosec = divmod(nanoseconds(time_s), 1_000_000_000)
        stamp = self._make("builtin_interfaces/Time", sec=sec, nanosec=nanosec)
        return self._make("std_msgs/Header", stamp=stamp, frame_id=frame)

    def _image(self, camera: str, image: NDArray[np.uint8], time_s: float) -> Message:
        is_grey = image.ndim == 2
        form = "mono8; png compressed mono8" if is_grey else "rgb8; jpeg compressed bgr8"
        data = cv2.imencode(".png", image)[1].tobytes() if is_grey else encode_jpeg(image, JPEG_QUALITY)
        content = self._make(
            "sensor_msgs/CompressedImage",
            header=self._header(_optical(camera), time_s),
            format=form,
            data=np.frombuffer(data, np.uint8),
        )
        return f"/{camera}/image/compressed", "sensor_msgs/msg/CompressedImage", content

    def _depth_images(
        self, camera: str, config: DepthConfig, images: Mapping[str, NDArray[Any]], time_s: float
    ) -> Iterator[Message]:
        """Say what a depth camera saw: depth without loss, its colours, and points with both."""
        depth, header = images[camera], self._header(_optical(camera), time_s)
        yield f"/{camera}/image", "sensor_msgs/msg/Image", self._image_of_16_bits(header, depth)
        colour = images[f"{camera}_colour"] if config.colour else None
        if colour is not None:
            _, kind, content = self._image(camera, colour, time_s)
            yield f"/{camera}/colour/image/compressed", kind, content
        yield f"/{camera}/points", "sensor_msgs/msg/PointCloud2", self._cloud(header, depth, colour, config)

    def _raw_thermal(self, camera: str, image_c: NDArray[np.float32], time_s: float) -> Message:
        """Say without loss what a thermal camera measured [K / 100]."""
        raw = self._image_of_16_bits(self._header(_optical(camera), time_s), encode_16bit(image_c))
        return f"/{camera}/image16", "sensor_msgs/msg/Image", raw

    def _image_of_16_bits(self, header: Any, image: NDArray[np.uint16]) -> Any:
        height, width = image.shape
        data = np.ascontiguousarray(image, "<u2").view(np.uint8).ravel()
        return self._make(
            "sensor_msgs/Image", header=header, height=height, width=width, encoding="16UC1", is_bigendian=0,
            step=2 * width, data=data,
        )  # fmt: skip

    def _cloud(
        self,
        header: Any,
        depth: NDArray[np.uint16],
        colour: NDArray[np.uint8] | None,
        config: DepthConfig,
    ) -> Any:
        """Give the points of every 4th pixel of every 4th row; colours are 0RGB, as in ROS's own clouds."""
        places, pixels = points_of(depth, config.camera, _POINT_EVERY)
        columns = {"x": places[:, 0], "y": places[:, 1], "z": places[:, 2]}
        if colour is not None:
            red, green, blue = colour[pixels[:, 0], pixels[:, 1]].T.astype(np.uint32)
            columns["rgb"] = (red << 16 | green << 8 | blue).view(np.float32)
        return self._points(header, columns)

    def _points(self, header: Any, columns: Mapping[str, NDArray[Any]]) -> Any:
        """Give points by the values (N,) of each of their fields, in 32 bits."""
        rows = np.stack([*columns.values()], axis=1).astype("<f4")
        fields = [
            self._make("sensor_msgs/PointField", name=name, offset=4 * k, datatype=_FLOAT32, count=1)
            for k, name in enumerate(columns)
        ]
        return self._make(
            "sensor_msgs/PointCloud2", header=header, height=1, width=len(rows), fields=fields,
            is_bigendian=False, point_step=4 * len(fields), row_step=4 * rows.size,
            data=rows.view(np.uint8).ravel(), is_dense=True,
        )  # fmt: skip

    def _camera_info(self, name: str, camera: Pinhole, time_s: float) -> Any:
        projection = np.hstack([camera.intrinsics, np.zeros((3, 1))])
        whole = self._make(
            "sensor_msgs/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        return self._make(
            "sensor_msgs/CameraInfo",
            header=self._header(_optical(name), time_s),
            height=camera.height,
            width=camera.width,
            distortion_model="plumb_bob",
            d=np.zeros(5),
            k=camera.intrinsics.ravel(),
            r=np.eye(3).ravel(),
            p=projection.ravel(),
            binning_x=0,
            binning_y=0,
            roi=whole,
        )

    def _detections(
        self, topic: str, found: list[tuple[str, Box, float]], time_s: float, camera: str = "thermal"
    ) -> Message:
        header = self._header(_optical(camera), time_s)
        detections = [self._detection(header, *one) for one in found]
        content = self._make("vision_msgs/Detection2DArray", header=header, detections=detections)
        return topic, "vision_msgs/msg/Detection2DArray", content

    def _detection(self, header: Any, name: str, box: Box, score: float) -> Any:
        left, top, width, height = box
        middle = self._make("vision_msgs/Point2D", x=left + width / 2.0, y=top + height / 2.0)
        centre = self._make("vision_msgs/Pose2D", position=middle, theta=0.0)
        hypothesis = self._make("vision_msgs/ObjectHypothesis", class_id="person", score=score)
        nowhere = self._pose_with_covariance(Pose2(0.0, 0.0, 0.0))
        return self._make(
            "vision_msgs/Detection2D",
            header=header,
            results=[self._make("vision_msgs/ObjectHypothesisWithPose", hypothesis=hypothesis, pose=nowhere)],
            bbox=self._make("vision_msgs/BoundingBox2D", center=centre, size_x=width, size_y=height),
            id=name,
        )

    def _places(self, tracks: Sequence[Track], time_s: float) -> Message:
        """Say where on the floor the tracker takes people to stand, with the covariance."""
        header = self._header(_BASE, time_s)
        detections = [
            self._standing(header, str(track.id), track.place, track.confidence)
            for track in tracks
            if track.status is not Status.TENTATIVE and track.place is not None
        ]
        content = self._make("vision_msgs/Detection3DArray", header=header, detections=detections)
        return "/tracks/places", "vision_msgs/msg/Detection3DArray", content

    def _standing(self, header: Any, name: str, place: FloorPlace, score: float) -> Any:
        pose = self._pose_with_covariance(Pose2(*place.position_m, 0.0))
        xx, xy, yy = place.covariance_m2
        pose.covariance[[0, 1, 6, 7]] = xx, xy, xy, yy
        hypothesis = self._make("vision_msgs/ObjectHypothesis", class_id="person", score=score)
        return self._make(
            "vision_msgs/Detection3D",
            header=header,
            results=[self._make("vision_msgs/ObjectHypothesisWithPose", hypothesis=hypothesis, pose=pose)],
            bbox=self._make("vision_msgs/BoundingBox3D", center=pose.pose, size=self._vector(0.0, 0.0, 0.0)),
            id=name,
        )

    def _echoes(self, sonar_m: NDArray[np.float64], time_s: float) -> Message:
        """Say what each sonar heard, as points on their axes.

        ROS's message for one sonar, Range, has other fields in Humble than from Iron on.
        """
        ahead = np.stack([np.cos(SONAR_ANGLE_RAD), np.sin(SONAR_ANGLE_RAD)], axis=1)
        places = SONAR_POSITION_M + sonar_m[:, None] * ahead
        columns = {"x": places[:, 0], "y": places[:, 1], "z": np.full(len(places), self._sonar_height_m)}
        cloud = self._points(self._header(_BASE, time_s), columns | {"range": sonar_m})
        return "/sonar", "sensor_msgs/msg/PointCloud2", cloud

    def _odometry(self, tick: Tick) -> Any:
        left, right = tick.observation.wheel_speeds_m_s
        twist = self._make(
            "geometry_msgs/Twist",
            linear=self._vector((left + right) / 2.0, 0.0, 0.0),
            angular=self._vector(0.0, 0.0, (right - left) / WHEEL_DISTANCE_M),
        )
        pose = self._pose_with_covariance(tick.observation.odometry)
        pose.covariance.reshape(6, 6)[_PLANE] = self._noise.carry(tick.observation.odometry)
        return self._make(
            "nav_msgs/Odometry",
            header=self._header(_ODOM, tick.observation.time_s),
            child_frame_id=_BASE,
            pose=pose,
            twist=self._make("geometry_msgs/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )

    def _frames(self, tick: Tick) -> list[Any]:
        """Place odometry in the world so that the robot comes to be where it is in truth, and people."""
        time_s, odometry = tick.observation.time_s, tick.observation.odometry
        frames = [
            self._transform(_MAP, _ODOM, drift(tick.truth.robot, odometry), time_s),
            self._transform(_ODOM, _BASE, odometry, time_s),
        ]
        for person in tick.truth.people:
            place = Pose2(*person.position_m, person.heading_rad)
            frames.append(self._transform(_MAP, f"people/{person.name}", place, time_s))
        return frames

    def _transform(self, parent: str, child: str, pose: Pose2, time_s: float) -> Any:
        turn = Rotation.from_euler("z", pose.heading).as_quat()
        return self._stamped(parent, child, (pose.x, pose.y, 0.0), turn, time_s)

    def _camera_pose(self, name: str, camera: CameraGeometry, time_s: float) -> Any:
        pose = camera.robot_from_camera
        turn = Rotation.from_matrix(pose[:3, :3]).as_quat()
        return self._stamped(_BASE, _optical(name), pose[:3, 3].tolist(), turn, time_s)

    def _stamped(
        self,
        parent: str,
        child: str,
        place: Sequence[float],
        turn: NDArray[np.float64],
        time_s: float,
    ) -> Any:
        transform = self._make(
            "geometry_msgs/Transform", translation=self._vector(*place), rotation=self._quaternion(turn)
        )
        return self._make(
            "geometry_msgs/TransformStamped",
            header=self._header(parent, time_s),
            child_frame_id=child,
            transform=transform,
        )

    def _pose_with_covariance(self, pose: Pose2) -> Any:
        turn = self._quaternion(Rotation.from_euler("z", pose.heading).as_quat())
        place = self._make("geometry_msgs/Point", x=pose.x, y=pose.y, z=0.0)
        return self._make(
            "geometry_msgs/PoseWithCovariance",
            pose=self._make("geometry_msgs/Pose", position=place, orientation=turn),
            covariance=np.zeros(36),
        )

    def _vector(self, x: float, y: float, z: float) -> Any:
        return self._make("geometry_msgs/Vector3", x=x, y=y, z=z)

    def _quaternion(self, turn: NDArray[np.float64]) -> Any:
        x, y, z, w = map(float, turn)
        return self._make("geometry_msgs/Quaternion", x=x, y=y, z=z, w=w)


def _optical(camera: str) -> str:
    """Name the optical frame of a camera."""
    return f"{camera}_optical"


def _people(truth: Truth) -> list[tuple[str, Box, float]]:
    """Give name, box and visible fraction of everybody in the image."""
    return [(p.name, p.box, p.visible_fraction) for p in truth.people if p.box is not None and p.is_in_image]


def nanoseconds(time_s: float) -> int:
    """Give a time [s] in whole nanoseconds."""
    return round(time_s * 1e9)


def drift(true: Pose2, odometry: Pose2) -> Pose2:
    """Give the pose of the odometry's frame in the world: with the odometry on top it gives the true pose."""
    heading = math.remainder(true.heading - odometry.heading, math.tau)
    cos, sin = math.cos(heading), math.sin(heading)
    return Pose2(
        true.x - cos * odometry.x + sin * odometry.y, true.y - sin * odometry.x - cos * odometry.y, heading
    )
