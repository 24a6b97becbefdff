"""Geometry of a depth image in metres."""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.track import Box

Depth = NDArray[np.uint16]
"""(H, W) [mm] along the optical axis, 0 for no reading."""

Image = NDArray[np.uint8]
"""(H, W, 3) RGB."""

BASELINE_M = 0.075
"""Baseline of the thesis's sensor; it only defines the unit of disparities."""


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
