"""Mount of the thermal camera: the properties that determine rows and sizes of people in its image."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration

USUAL_HEIGHT_M: Final = 1.2  # above the floor, to which the limits of the variants refer
VIEW_ANGLE_DEG: Final = 44.0  # vertical field of view of an uncalibrated camera
STATURES_M: Final = (2.0, 1.5)  # of the tallest and of the smallest people to detect
_NEAR_M: Final = 3.0
_FAR: Final = 100.0  # [image heights] beyond which the horizon's position is irrelevant


@dataclass(frozen=True, slots=True)
class Mount:
    """Mount of a camera.

    Attributes:
        horizon_px: row of the horizon [px]; it may lie outside the image.
        focal_px: focal length [px].
        height_m: height of the camera above the floor [m].
    """

    horizon_px: float
    focal_px: float
    height_m: float

    @property
    def cuts_heads(self) -> bool:
        """Whether the image ends below the heads of tall people unless they are very near."""
        return self.horizon_px < self.focal_px * (STATURES_M[0] - self.height_m) / _NEAR_M


def mount_of(calibration: Calibration | None, rows: int) -> Mount:
    """Return the mount of a camera; an uncalibrated one is assumed level and at the usual height.

    Args:
        calibration: of the camera; None if unknown.
        rows: height of its image [px].
    """
    if not isinstance(calibration, PinholeCalibration):
        focal = rows / 2 / math.tan(math.radians(VIEW_ANGLE_DEG) / 2)
        return Mount((rows - 1) / 2, focal, USUAL_HEIGHT_M)
    column = calibration.intrinsics[0, 2]
    top, bottom = calibration.rays(np.array([[column, 0.0], [column, rows - 1.0]]))[:, 2].tolist()
    # A camera that looks straight down or up has no horizon, which is treated as far away.
    far = _FAR * rows
    away = (rows - 1) * top / (top - bottom) if top != bottom else math.copysign(far, top)
    # Rounded so that a level camera's horizon is exactly the middle of its image.
    horizon = round(max(-far, min(away, far)), 6)
    return Mount(horizon, float(calibration.intrinsics[1, 1]), calibration.position_m[2])
