"""Geometry of a depth image in metres, and the view of a level camera."""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.geometry.small_matrices import inverse
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Floats, Frame
from peopleboy.tracker.track import Box

Depth = NDArray[np.uint16]
"""(H, W) [mm] along the optical axis, 0 for no reading."""

Image = NDArray[np.uint8]
"""(H, W, 3) RGB."""

BASELINE_M = 0.075
"""Baseline of the thesis's sensor; it only defines the unit of disparities."""

_STEEPEST_RAD: Final = math.radians(45.0)
_STEEPEST: Final = 1.2  # tangent of the steepest ray of a level image: beyond, pixels are stretched too much
_TORSO: Final = 0.35  # row of a box, in heights from the top, in which its width is measured


@dataclass(frozen=True, slots=True)
class DepthView:
    """Geometry of a planar depth image.

    The optical frame is x right, y down, z forward [m].

    Attributes:
        focal_px: focal length [px].
        centre_u, centre_v: principal point [px].
        calibration: pose of the camera on the robot.
    """

    focal_px: float
    centre_u: float
    centre_v: float
    calibration: PinholeCalibration

    @classmethod
    def of(cls, calibration: Calibration | None, camera: str) -> "DepthView":
        """Make the geometry of a calibrated camera.

        Raises:
            BadInput: the camera is not calibrated, or not planar.
        """
        if not isinstance(calibration, PinholeCalibration):
            raise BadInput(f"camera {camera!r}: the tracker wants a calibrated one with a flat image")
        matrix = calibration.intrinsics
        return cls(float(matrix[0, 0]), float(matrix[0, 2]), float(matrix[1, 2]), calibration)

    @property
    def disparity_px_m(self) -> float:
        """Disparity [px] at a depth of 1 m."""
        return self.focal_px * BASELINE_M

    @property
    def height_m(self) -> float:
        """Height of the camera above the floor."""
        return self.calibration.position_m[2]

    @property
    def horizon_px(self) -> float:
        """Rows of the horizon below the principal point; negative above."""
        forward, down = self.calibration.robot_from_camera[2, 2], self.calibration.robot_from_camera[2, 1]
        return float(self.focal_px * forward / -down) if down else 0.0

    def on_floor(self, x_m: Floats, z_m: Floats) -> Floats:
        """Return positions (N, 2) on the floor, forward and left, of points at the height of the horizon."""
        points = np.stack([x_m, np.zeros_like(x_m), z_m], axis=-1)
        pose = self.calibration.robot_from_camera
        return np.asarray(points @ pose[:2, :3].T + pose[:2, 3])


@dataclass(frozen=True, slots=True, eq=False)
class LevelView:
    """The view of a level camera at the position of a pitched one: a rotation of its rays.

    There, walls are vertical planes of one depth in each column, and people have one depth from head to feet.

    Attributes:
        calibration: of the level camera.
        shape: rows and columns of its image, which contains the other one.
        level_from_image: (3, 3) homography of pixels; None if the camera is level.
    """

    calibration: PinholeCalibration
    shape: tuple[int, int]
    level_from_image: Floats | None

    @classmethod
    def of(cls, calibration: PinholeCalibration, shape: tuple[int, int]) -> "LevelView":
        """Make the view for a camera with images of some rows and columns.

        A camera that is steeper than 45 degrees keeps its own view.
        """
        pose, intrinsics = calibration.robot_from_camera, calibration.intrinsics
        is_level = np.allclose(pose[2, :3], [0.0, -1.0, 0.0], atol=1e-6)
        if is_level or abs(pose[2, 2]) > math.sin(_STEEPEST_RAD):
            return cls(calibration, shape, None)
        level = pose.copy()
        level[:3, :3] = _level_axes(pose[:3, 2])
        level_from_pixel = level[:3, :3].T @ pose[:3, :3] @ inverse(intrinsics)
        rows, columns = shape
        corners = np.array([[u, v, 1.0] for u in (0.0, columns - 1.0) for v in (0.0, rows - 1.0)])
        rays = corners @ level_from_pixel.T
        rays = np.clip(rays[:, :2] / np.maximum(rays[:, 2:], 0.1), -_STEEPEST, _STEEPEST)
        first, last = (rays.min(axis=0), rays.max(axis=0)) @ intrinsics[:2, :2].T
        matrix = intrinsics.copy()
        matrix[:2, 2] = -np.floor(first)
        width, height = np.ceil(last - np.floor(first)).astype(int) + 1
        return cls(PinholeCalibration(matrix, level), (int(height), int(width)), matrix @ level_from_pixel)

    def transform_frame(self, frame: Frame) -> Frame:
        """Return a frame with the depth camera's images as the level camera sees them."""
        if self.level_from_image is None:
            return frame
        size = self.shape[1], self.shape[0]
        near = cv2.warpPerspective(frame.depth(DEPTH), self.level_from_image, size, flags=cv2.INTER_NEAREST)
        images: dict[str, NDArray[Any]] = {DEPTH: _deepen(np.asarray(near, np.uint16), self.level_from_image)}
        if DEPTH_COLOUR in frame.images:
            images[DEPTH_COLOUR] = cv2.warpPerspective(
                frame.rgb(DEPTH_COLOUR), self.level_from_image, size, borderMode=cv2.BORDER_REPLICATE
            )
        if THERMAL in frame.images:
            images[THERMAL] = frame.images[THERMAL]
        return replace(frame, images=images, calibrations={**frame.calibrations, DEPTH: self.calibration})

    def boxes_in_image(self, boxes: Floats) -> Floats:
        """Return boxes (N, 4) [px] of the level image in that of the camera, as wide as at the torso."""
        if self.level_from_image is None or not len(boxes):
            return boxes
        left, top, width, height = boxes.T
        middle, torso = left + width / 2.0, top + _TORSO * height
        ends = [(middle, top), (middle, top + height), (left, torso), (left + width, torso)]
        pixels = np.stack([np.stack(end, axis=1) for end in ends])
        back = inverse(self.level_from_image)
        (_, first), (_, last), (start, _), (end, _) = cv2.perspectiveTransform(pixels, back).transpose(
            0, 2, 1
        )
        return np.stack([start, first, end - start, last - first], axis=1)


def _deepen(depth: Depth, level_from_image: Floats) -> Depth:
    """Return a depth image (H, W) along the level axis, from readings along the camera's."""
    across, down, straight = inverse(level_from_image)[2]
    rows, columns = (np.arange(count) for count in depth.shape)
    by_level = across * columns + down * rows[:, None] + straight  # depth of each ray by its level depth
    return np.asarray(np.minimum(np.rint(depth / np.maximum(by_level, 0.1)), 65535.0), np.uint16)


def _level_axes(forward: Floats) -> Floats:
    """Return the axes (3, 3) of a level camera with the heading of an optical axis (3,)."""
    ahead = np.array([forward[0], forward[1], 0.0]) / np.hypot(forward[0], forward[1])
    down = np.array([0.0, 0.0, -1.0])
    return np.column_stack([np.cross(down, ahead), down, ahead])


@dataclass(frozen=True, slots=True, eq=False)
class RgbdView:
    """One frame of the sensor.

    Attributes:
        depth: (H, W) [mm].
        colour: (H, W, 3) RGB of the same pixels.
        geometry: how pixels map to metres.
        body_m: [m] from the visible surface to the middle of a body.
    """

    depth: Depth
    colour: Image
    geometry: DepthView
    body_m: float


def box_at(geometry: DepthView, place_m: Floats, width_m: float, head_m: float, low_m: float = 0.0) -> Box:
    """Return the box [px] of a person at a position (2,), which may reach outside the image.

    Args:
        geometry: of the image.
        place_m: forward, left in the robot frame.
        width_m: of the person.
        head_m: height of the top above the floor.
        low_m: height of the lowest visible part.
    """
    pose = geometry.calibration.robot_from_camera
    intrinsics = np.array([geometry.focal_px, geometry.centre_u, geometry.centre_v])
    left, top, width, height, _ = project_body(
        pose[:3, :3], pose[:3, 3], intrinsics, place_m, width_m, head_m, low_m
    )
    return left, top, width, height


@njit(cache=True, nogil=True)
def project_body(
    rotation: Floats,
    origin: Floats,
    camera: Floats,
    place: Floats,
    width_m: float,
    head_m: float,
    low_m: float,
) -> tuple[float, float, float, float, float]:
    """Return left, top, width, height [px] and depth [m] of a body; depth 0 behind the camera."""
    ends = np.empty((2, 3))
    for k in range(2):
        dx, dy, dz = place[0] - origin[0], place[1] - origin[1], (head_m if k == 0 else low_m) - origin[2]
        for axis in range(3):
            ends[k, axis] = rotation[0, axis] * dx + rotation[1, axis] * dy + rotation[2, axis] * dz
    depth = 0.5 * (ends[0, 2] + ends[1, 2])
    if min(ends[0, 2], ends[1, 2]) < 0.2:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    focal = camera[0]
    width = focal * width_m / depth
    middle = camera[1] + focal * 0.5 * (ends[0, 0] / ends[0, 2] + ends[1, 0] / ends[1, 2])
    top = camera[2] + focal * ends[0, 1] / ends[0, 2]
    bottom = camera[2] + focal * ends[1, 1] / ends[1, 2]
    return middle - width / 2.0, top, width, bottom - top, depth
