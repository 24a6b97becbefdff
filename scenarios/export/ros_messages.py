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
from rosbags.interfaces import Nodetype
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
from peopleboy.sim.geometry.pinhole import CameraGeometry, Pinhole
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, SONAR_POSITION_M, WHEEL_DISTANCE_M
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.truth import Box, Truth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track, confirmed


class OdometryCovariance:
    """Add up the errors of wheel encoders, to first order, without slip of the wheels.

    Args:
        encoder_noise_m: [m] standard deviation of the way that a wheel's encoder counts on 1 m.
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


Message = tuple[str, str, Any]  # topic, type, content
Content = dict[str, Any]

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
    """Return all message types in use."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in _VISION.items():
        store.register(get_types_from_msg(text, f"vision_msgs/msg/{name}"))
    return store


def build(types: Typestore, kind: str, content: Mapping[str, Any]) -> Any:
    """Build a message, and those inside it, from nested mappings with a value for every field.

    Args:
        types: from `message_types`.
        kind: its type, such as `std_msgs/msg/Header`.
        content: values by field; of fields that are messages, again mappings.
    """

    def field(form: tuple[Nodetype, Any], value: Any) -> Any:
        node, inner = form
        if node is Nodetype.NAME:
            return build(types, inner, value)
        if node is Nodetype.SEQUENCE and inner[0][0] is Nodetype.NAME:
            return [field(inner[0], each) for each in value]
        return value

    forms = types.fielddefs[kind][1]
    return types.types[kind](**{name: field(form, content[name]) for name, form in forms})


class RosMessages:
    """Turn ticks, in their order, into messages.

    Args:
        robot: whose cameras they are.
        types: from `message_types`.
    """

    def __init__(self, robot: RobotConfig, types: Typestore) -> None:
        self._types = types
        self._cameras = robot.cameras
        self._sonar_height_m = robot.sonar.height_m
        self._further = further_cameras(robot.cameras)
        self._noise = OdometryCovariance(robot.drive.encoder_noise_m)

    def fixed(self, time_s: float) -> Iterator[Message]:
        """Yield, once, where the cameras are on the robot."""
        poses = [_camera_pose(name, camera.camera, time_s) for name, camera in self._cameras.items()]
        yield self._built("/tf_static", "tf2_msgs/TFMessage", {"transforms": poses})

    def tick(self, tick: Tick) -> Iterator[Message]:
        """Yield all messages of one tick."""
        for topic, kind, content in (*self._images(tick), *self._people(tick), *self._robot(tick)):
            yield self._built(topic, kind, content)

    def _built(self, topic: str, kind: str, content: Content) -> Message:
        kind = kind.replace("/", "/msg/")
        return topic, kind, build(self._types, kind, content)

    def _images(self, tick: Tick) -> Iterator[Message]:
        images, time_s = tick.observation.images, tick.observation.time_s
        due = {name: camera for name, camera in self._cameras.items() if name in images}
        for name, config in due.items():
            header = _header(_optical(name), time_s)
            if isinstance(config, DepthConfig):
                yield from _depth_images(header, name, config, images)
            else:
                yield _image(header, f"/{name}/image", images[name])
            if isinstance(config, ThermalConfig):  # without loss, in K / 100
                raw = _image_of_16_bits(header, encode_16bit(images[f"{name}_c"]))
                yield f"/{name}/image16", "sensor_msgs/Image", raw
        for name, config in due.items():
            if isinstance(config.camera, Pinhole):  # the message knows no other geometry
                content = _camera_info(_header(_optical(name), time_s), config.camera)
                yield f"/{name}/camera_info", "sensor_msgs/CameraInfo", content

    def _people(self, tick: Tick) -> Iterator[Message]:
        time_s = tick.observation.time_s
        yield _detections("/truth/people", _people(tick.truth), time_s)
        for name in (name for name in self._further if name in tick.truths):
            yield _detections(f"/truth/{name}/people", _people(tick.truths[name]), time_s, name)
        for name in (name for name in self._cameras if name in tick.observation.images):
            tracks = [(str(t.id), box, t.confidence) for t, box in confirmed(tick.tracks, name)]
            if name == THERMAL:
                yield _detections("/tracks", tracks, time_s)
            elif tracks:
                yield _detections(f"/tracks/{name}", tracks, time_s, name)
        yield _places(tick.tracks, _header(_BASE, time_s))

    def _robot(self, tick: Tick) -> Iterator[Message]:
        time_s, odometry = tick.observation.time_s, tick.observation.odometry
        echoes = _echoes(tick.observation.sonar_m, self._sonar_height_m)
        yield "/sonar", "sensor_msgs/PointCloud2", _points(_header(_BASE, time_s), echoes)
        left, right = tick.observation.wheel_speeds_m_s
        twist = {
            "linear": _vector((left + right) / 2.0, 0.0, 0.0),
            "angular": _vector(0.0, 0.0, (right - left) / WHEEL_DISTANCE_M),
        }
        content = {
            "header": _header(_ODOM, time_s),
            "child_frame_id": _BASE,
            "pose": _pose_with_covariance(odometry, self._noise.carry(odometry)),
            "twist": {"twist": twist, "covariance": np.zeros(36)},
        }
        yield "/odom", "nav_msgs/Odometry", content
        yield "/tf", "tf2_msgs/TFMessage", {"transforms": _frames(tick)}


def _header(frame: str, time_s: float) -> Content:
    sec, nanosec = divmod(nanoseconds(time_s), 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame}


def _image(header: Content, topic: str, image: NDArray[np.uint8]) -> Message:
    is_grey = image.ndim == 2
    form = "mono8; png compressed mono8" if is_grey else "rgb8; jpeg compressed bgr8"
    data = cv2.imencode(".png", image)[1].tobytes() if is_grey else encode_jpeg(image, JPEG_QUALITY)
    content = {"header": header, "format": form, "data": np.frombuffer(data, np.uint8)}
    return f"{topic}/compressed", "sensor_msgs/CompressedImage", content


def _depth_images(
    header: Content, camera: str, config: DepthConfig, images: Mapping[str, NDArray[Any]]
) -> Iterator[Message]:
    """Yield what a depth camera saw: depth without loss, its colours, and points with both.

    Points are those of every 4th pixel of every 4th row; colours are 0RGB, as in ROS's own clouds.
    """
    yield f"/{camera}/image", "sensor_msgs/Image", _image_of_16_bits(header, images[camera])
    places, pixels = points_of(images[camera], config.camera, _POINT_EVERY)
    columns = dict(zip("xyz", places.T, strict=True))
    if config.colour:
        colour = images[f"{camera}_colour"]
        yield _image(header, f"/{camera}/colour/image", colour)
        red, green, blue = colour[pixels[:, 0], pixels[:, 1]].T.astype(np.uint32)
        columns["rgb"] = (red << 16 | green << 8 | blue).view(np.float32)
    yield f"/{camera}/points", "sensor_msgs/PointCloud2", _points(header, columns)


def _image_of_16_bits(header: Content, image: NDArray[np.uint16]) -> Content:
    height, width = image.shape
    data = np.ascontiguousarray(image, "<u2").view(np.uint8).ravel()
    return {
        "header": header, "height": height, "width": width, "encoding": "16UC1", "is_bigendian": 0,
        "step": 2 * width, "data": data,
    }  # fmt: skip


def _points(header: Content, columns: Mapping[str, NDArray[Any]]) -> Content:
    """Describe points by the values (N,) of each of their fields, in 32 bits."""
    rows = np.stack([*columns.values()], axis=1).astype("<f4")
    fields = [
        {"name": name, "offset": 4 * k, "datatype": _FLOAT32, "count": 1} for k, name in enumerate(columns)
    ]
    return {
        "header": header, "height": 1, "width": len(rows), "fields": fields, "is_bigendian": False,
        "point_step": 4 * len(fields), "row_step": 4 * rows.size, "data": rows.view(np.uint8).ravel(),
        "is_dense": True,
    }  # fmt: skip


def _camera_info(header: Content, camera: Pinhole) -> Content:
    whole = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
    return {
        "header": header, "height": camera.height, "width": camera.width, "distortion_model": "plumb_bob",
        "d": np.zeros(5), "k": camera.intrinsics.ravel(), "r": np.eye(3).ravel(),
        "p": np.hstack([camera.intrinsics, np.zeros((3, 1))]).ravel(), "binning_x": 0, "binning_y": 0,
        "roi": whole,
    }  # fmt: skip


def _detections(
    topic: str, found: Sequence[tuple[str, Box, float]], time_s: float, camera: str = "thermal"
) -> Message:
    """Describe people in a camera's image by name, box and score."""
    header = _header(_optical(camera), time_s)
    nowhere = _pose_with_covariance(Pose2(0.0, 0.0, 0.0))
    detections = []
    for name, (left, top, width, height), score in found:
        middle = {"x": left + width / 2.0, "y": top + height / 2.0}
        box = {"center": {"position": middle, "theta": 0.0}, "size_x": width, "size_y": height}
        detections.append(_detection(header, name, score, nowhere, box))
    return topic, "vision_msgs/Detection2DArray", {"header": header, "detections": detections}


def _places(tracks: Sequence[Track], header: Content) -> Message:
    """Describe where on the floor the tracker takes people to stand, with the covariance."""
    detections = []
    for track in tracks:
        if track.status is not Status.TENTATIVE and track.place is not None:
            xx, xy, yy = track.place.covariance_m2
            covariance = np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 0.0]])
            pose = _pose_with_covariance(Pose2(*track.place.position_m, 0.0), covariance)
            box = {"center": pose["pose"], "size": _vector(0.0, 0.0, 0.0)}
            detections.append(_detection(header, str(track.id), track.confidence, pose, box))
    return "/tracks/places", "vision_msgs/Detection3DArray", {"header": header, "detections": detections}


def _detection(header: Content, name: str, score: float, pose: Content, box: Content) -> Content:
    hypothesis = {"hypothesis": {"class_id": "person", "score": score}, "pose": pose}
    return {"header": header, "results": [hypothesis], "bbox": box, "id": name}


def _echoes(sonar_m: NDArray[np.float64], height_m: float) -> Mapping[str, NDArray[np.float64]]:
    """Return what each sonar measured, as points on their axes, and the ranges.

    ROS's message for one sonar, Range, has other fields in Humble than from Iron on.
    """
    ahead = np.stack([np.cos(SONAR_ANGLE_RAD), np.sin(SONAR_ANGLE_RAD)], axis=1)
    x, y = (SONAR_POSITION_M + sonar_m[:, None] * ahead).T
    return {"x": x, "y": y, "z": np.full(len(x), height_m), "range": sonar_m}


def _frames(tick: Tick) -> list[Content]:
    """Place odometry in the world so that the robot gets its true pose, and people."""
    time_s, odometry = tick.observation.time_s, tick.observation.odometry
    poses = [(_MAP, _ODOM, drift(tick.truth.robot, odometry)), (_ODOM, _BASE, odometry)]
    poses += [
        (_MAP, f"people/{person.name}", Pose2(*person.position_m, person.heading_rad))
        for person in tick.truth.people
    ]
    return [
        _transform(_header(parent, time_s), child, (pose.x, pose.y, 0.0), _turn(pose))
        for parent, child, pose in poses
    ]


def _camera_pose(name: str, camera: CameraGeometry, time_s: float) -> Content:
    pose = camera.robot_from_camera
    turn = Rotation.from_matrix(pose[:3, :3]).as_quat()
    return _transform(_header(_BASE, time_s), _optical(name), pose[:3, 3].tolist(), turn)


def _transform(header: Content, child: str, place: Sequence[float], turn: NDArray[np.float64]) -> Content:
    transform = {"translation": _vector(*place), "rotation": _quaternion(turn)}
    return {"header": header, "child_frame_id": child, "transform": transform}


def _pose_with_covariance(pose: Pose2, covariance: NDArray[np.float64] | None = None) -> Content:
    """Describe a pose on the floor with the covariance (3, 3) of x, y [m] and heading [rad]; None for 0."""
    spatial = np.zeros((6, 6))
    if covariance is not None:
        spatial[_PLANE] = covariance
    place = {"position": _vector(pose.x, pose.y, 0.0), "orientation": _quaternion(_turn(pose))}
    return {"pose": place, "covariance": spatial.ravel()}


def _turn(pose: Pose2) -> NDArray[np.float64]:
    return np.asarray(Rotation.from_euler("z", pose.heading).as_quat())


def _vector(x: float, y: float, z: float) -> Content:
    return {"x": x, "y": y, "z": z}


def _quaternion(turn: NDArray[np.float64]) -> Content:
    return dict(zip("xyzw", map(float, turn), strict=True))


def _optical(camera: str) -> str:
    """Name the optical frame of a camera."""
    return f"{camera}_optical"


def _people(truth: Truth) -> list[tuple[str, Box, float]]:
    """Return name, box and visible fraction of all people in the image."""
    return [(p.name, p.box, p.visible_fraction) for p in truth.people if p.box is not None and p.is_in_image]


def nanoseconds(time_s: float) -> int:
    """Convert a time [s] to whole nanoseconds."""
    return round(time_s * 1e9)


def drift(true: Pose2, odometry: Pose2) -> Pose2:
    """Return the pose of the odometry's frame in the world: composed with the odometry, the true pose."""
    heading = math.remainder(true.heading - odometry.heading, math.tau)
    cos, sin = math.cos(heading), math.sin(heading)
    return Pose2(
        true.x - cos * odometry.x + sin * odometry.y, true.y - sin * odometry.x - cos * odometry.y, heading
    )
