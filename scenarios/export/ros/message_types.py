"""ROS 2 message types, and messages made from nested mappings.

Stamps are whole nanoseconds, counted from the start of the run or from an epoch.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from scipy.spatial.transform import Rotation

from peopleboy.geometry.pose2 import Pose2

Message = tuple[str, str, Any]  # topic, type, content
Content = dict[str, Any]
RosDistro = Literal["humble", "jazzy"]

_PLANE = np.ix_((0, 1, 5), (0, 1, 5))  # indices of x, y and rotation about z in a 6 x 6 covariance
MAP, ODOM, BASE = "map", "odom", "base_link"
_STORES: Final = {"humble": Stores.ROS2_HUMBLE, "jazzy": Stores.ROS2_JAZZY}

# vision_msgs 4 and people_msgs, which are not part of the base installation of ROS.
_MORE: Final = {
    "vision_msgs/msg/Point2D": "float64 x\nfloat64 y",
    "vision_msgs/msg/Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
    "vision_msgs/msg/BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "vision_msgs/msg/ObjectHypothesis": "string class_id\nfloat64 score",
    "vision_msgs/msg/ObjectHypothesisWithPose": (
        "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose"
    ),
    "vision_msgs/msg/Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nstring id"
    ),
    "vision_msgs/msg/Detection2DArray": "std_msgs/Header header\nvision_msgs/Detection2D[] detections",
    "vision_msgs/msg/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
    "vision_msgs/msg/Detection3D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox3D bbox\nstring id"
    ),
    "vision_msgs/msg/Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections",
    "people_msgs/msg/Person": (
        "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point velocity\nfloat64 reliability\n"
        "string[] tagnames\nstring[] tags"
    ),
    "people_msgs/msg/People": "std_msgs/Header header\npeople_msgs/Person[] people",
}


def message_types(distro: RosDistro = "jazzy") -> Typestore:
    """Return all message types in use, as a ROS distribution defines them.

    Between Humble and Jazzy only sensor_msgs/Range differs: since Iron it has a variance.
    """
    store = get_typestore(_STORES[distro])
    for name, text in _MORE.items():
        store.register(get_types_from_msg(text, name))
    return store


def build(types: Typestore, kind: str, content: Mapping[str, Any]) -> Any:
    """Build a message, and those inside it, from nested mappings with a value for every field.

    Args:
        types: from `message_types`.
        kind: its type, such as `std_msgs/msg/Header`.
        content: values by field; mappings for fields that are messages.
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


def nanoseconds(time_s: float) -> int:
    """Convert a time [s] to whole nanoseconds."""
    return round(time_s * 1e9)


def stamp(time_ns: int) -> Content:
    """Return the Time message of an instant."""
    sec, nanosec = divmod(time_ns, 1_000_000_000)
    return {"sec": sec, "nanosec": nanosec}


def header(frame: str, time_ns: int) -> Content:
    """Return the Header message of a time and a frame."""
    return {"stamp": stamp(time_ns), "frame_id": frame}


def optical(camera: str) -> str:
    """Return the name of a camera's optical frame."""
    return f"{camera}_optical"


def vector(x: float, y: float, z: float) -> Content:
    """Return the message of a vector or a point."""
    return {"x": x, "y": y, "z": z}


def quaternion(turn: NDArray[np.float64]) -> Content:
    """Return the message of a rotation (4,) x, y, z, w."""
    return dict(zip("xyzw", map(float, turn), strict=True))


def heading_quaternion(heading_rad: float) -> Content:
    """Return the message of a rotation about the vertical axis."""
    return quaternion(np.asarray(Rotation.from_euler("z", heading_rad).as_quat()))


def pose_at(x: float, y: float, z: float = 0.0, heading_rad: float = 0.0) -> Content:
    """Return the message of an upright pose."""
    return {"position": vector(x, y, z), "orientation": heading_quaternion(heading_rad)}


def pose_with_covariance(pose: Pose2, covariance: NDArray[np.float64] | None = None) -> Content:
    """Return the message of a floor pose with covariance (3, 3) of x, y [m], heading [rad]; None for 0."""
    spatial = np.zeros((6, 6))
    if covariance is not None:
        spatial[_PLANE] = covariance
    return {"pose": pose_at(pose.x, pose.y, heading_rad=pose.heading), "covariance": spatial.ravel()}


def transform_between(parent: Content, child: str, place: Sequence[float], turn: Content) -> Content:
    """Return the message of a frame's pose in the frame of a header."""
    transform = {"translation": vector(*place), "rotation": turn}
    return {"header": parent, "child_frame_id": child, "transform": transform}
