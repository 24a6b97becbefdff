"""ROS 2 messages of cameras: images, points, scans and calibrations, named as drivers name them."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.overlay import encode_jpeg
from peopleboy.scenarios.export.ros.message_types import Content, Message, header, optical
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig, LaserConfig, ThermalConfig
from peopleboy.sim.cameras.depth import points_of
from peopleboy.sim.cameras.thermal import encode_16bit
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.world_config import CONTROL_HZ

JPEG_QUALITY: Final = 90
_POINT_EVERY = 4
_FLOAT32 = 7  # of sensor_msgs/PointField


def image_messages(
    cameras: Mapping[str, CameraConfig], images: Mapping[str, NDArray[Any]], time_ns: int
) -> Iterator[Message]:
    """Yield the images of all cameras that have one at this tick, and their calibrations."""
    due = {name: camera for name, camera in cameras.items() if name in images}
    for name, config in due.items():
        head = header(optical(name), time_ns)
        if isinstance(config, DepthConfig):
            yield from _depth_images(head, name, config, images)
        elif isinstance(config, LaserConfig):
            scan = _scan(header(name, time_ns), config, images[name][0])
            yield f"/{name}/scan", "sensor_msgs/LaserScan", scan
        else:
            yield _image(head, f"/{name}/image_raw", images[name])
        if isinstance(config, ThermalConfig):  # without loss, in K / 100
            raw = _image_of_16_bits(head, encode_16bit(images[f"{name}_c"]))
            yield f"/{name}/image16", "sensor_msgs/Image", raw
    for name, config in due.items():
        if isinstance(config.camera, Pinhole):  # the message supports no other geometry
            content = _camera_info(header(optical(name), time_ns), config.camera)
            yield f"/{name}/camera_info", "sensor_msgs/CameraInfo", content


def _image(head: Content, topic: str, image: NDArray[np.uint8]) -> Message:
    is_grey = image.ndim == 2
    form = "mono8; png compressed mono8" if is_grey else "rgb8; jpeg compressed bgr8"
    data = cv2.imencode(".png", image)[1].tobytes() if is_grey else encode_jpeg(image, JPEG_QUALITY)
    content = {"header": head, "format": form, "data": np.frombuffer(data, np.uint8)}
    return f"{topic}/compressed", "sensor_msgs/CompressedImage", content


def _depth_images(
    head: Content, camera: str, config: DepthConfig, images: Mapping[str, NDArray[Any]]
) -> Iterator[Message]:
    """Yield the messages of a depth camera: lossless depth, colour image, and a coloured point cloud.

    The cloud has every 4th pixel of every 4th row; colours are 0RGB, as in ROS's own clouds.
    """
    yield f"/{camera}/image_raw", "sensor_msgs/Image", _image_of_16_bits(head, images[camera])
    places, pixels = points_of(images[camera], config.camera, _POINT_EVERY)
    columns = dict(zip("xyz", places.T, strict=True))
    if config.colour:
        colour = images[f"{camera}_colour"]
        yield _image(head, f"/{camera}/colour/image_raw", colour)
        red, green, blue = colour[pixels[:, 0], pixels[:, 1]].T.astype(np.uint32)
        columns["rgb"] = (red << 16 | green << 8 | blue).view(np.float32)
    yield f"/{camera}/points", "sensor_msgs/PointCloud2", points_message(head, columns)


def _scan(head: Content, config: LaserConfig, ranges: NDArray[np.uint16]) -> Content:
    """Return a scan, whose beams turn to the left in ROS; infinity for no reading, as in REP 117."""
    plane, metres = config.camera, ranges[::-1] / np.float32(1000.0)
    half_rad = (plane.width - 1) / 2.0 * plane.step_rad
    return {
        "header": head, "angle_min": -half_rad, "angle_max": half_rad, "angle_increment": plane.step_rad,
        "time_increment": 0.0, "scan_time": 1.0 / (config.rate_hz or CONTROL_HZ),
        "range_min": config.nearest_m, "range_max": config.farthest_m,
        "ranges": np.where(metres > 0.0, metres, np.float32(np.inf)), "intensities": np.zeros(0, np.float32),
    }  # fmt: skip


def _image_of_16_bits(head: Content, image: NDArray[np.uint16]) -> Content:
    height, width = image.shape
    data = np.ascontiguousarray(image, "<u2").view(np.uint8).ravel()
    return {
        "header": head, "height": height, "width": width, "encoding": "16UC1", "is_bigendian": 0,
        "step": 2 * width, "data": data,
    }  # fmt: skip


def points_message(head: Content, columns: Mapping[str, NDArray[Any]]) -> Content:
    """Return a point cloud from the values (N,) of each of its fields, in 32 bits."""
    rows = np.stack([*columns.values()], axis=1).astype("<f4")
    fields = [
        {"name": name, "offset": 4 * k, "datatype": _FLOAT32, "count": 1} for k, name in enumerate(columns)
    ]
    return {
        "header": head, "height": 1, "width": len(rows), "fields": fields, "is_bigendian": False,
        "point_step": 4 * len(fields), "row_step": 4 * rows.size, "data": rows.view(np.uint8).ravel(),
        "is_dense": True,
    }  # fmt: skip


def _camera_info(head: Content, camera: Pinhole) -> Content:
    whole = {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False}
    return {
        "header": head, "height": camera.height, "width": camera.width, "distortion_model": "plumb_bob",
        "d": np.zeros(5), "k": camera.intrinsics.ravel(), "r": np.eye(3).ravel(),
        "p": np.hstack([camera.intrinsics, np.zeros((3, 1))]).ravel(), "binning_x": 0, "binning_y": 0,
        "roi": whole,
    }  # fmt: skip
