"""Geometry of a depth image in metres."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.frame import Floats

Depth = NDArray[np.uint16]
"""(H, W) [mm] along the optical axis, 0 for no reading."""

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
