"""Where a camera sits on its robot, and which way each of its pixels looks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput

Floats = NDArray[np.float64]


class Calibration(Protocol):
    """What a tracker must know of a camera to tell metres from pixels.

    The robot's frame is x forward, y left, z up, with z = 0 on the floor [m]; pixels are u right, v down from
    the middle of the first one.
    """

    @property
    def position_m(self) -> tuple[float, float, float]:
        """Optical centre in the robot's frame [m]."""
        ...

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2); NaN where the camera cannot see them."""
        ...

    def rays(self, pixels: Floats) -> Floats:
        """Give the directions (N, 3) in the robot's frame in which pixels (N, 2) look, of any length."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class PinholeCalibration:
    """Calibration of a camera whose image is flat and free of distortion.

    Attributes:
        intrinsics: (3, 3) [px] camera matrix.
        robot_from_camera: (4, 4) pose of the optical frame, x right, y down, z forward, in the robot's.

    Raises:
        BadInput: a matrix of another shape, or with a number that is not finite.
    """

    intrinsics: Floats
    robot_from_camera: Floats
    _robot_from_pixel: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Refuse what is no calibration."""
        for name, shape in (("intrinsics", (3, 3)), ("robot_from_camera", (4, 4))):
            matrix = getattr(self, name)
            if np.shape(matrix) != shape or not np.isfinite(matrix).all():
                raise BadInput(f"calibration: {name} must be {shape} and finite, got {np.shape(matrix)}")
        unprojected = self.robot_from_camera[:3, :3] @ np.linalg.inv(self.intrinsics)
        object.__setattr__(self, "_robot_from_pixel", unprojected)

    @property
    def position_m(self) -> tuple[float, float, float]:
        """Optical centre in the robot's frame [m]."""
        x, y, z = self.robot_from_camera[:3, 3].tolist()
        return x, y, z

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2); NaN for those behind the camera."""
        rotation, origin = self.robot_from_camera[:3, :3], self.robot_from_camera[:3, 3]
        seen = (points_m - origin) @ rotation @ self.intrinsics.T
        depth = np.where(seen[:, 2:] > 1e-9, seen[:, 2:], np.nan)
        return np.asarray(seen[:, :2] / depth, np.float64)

    def rays(self, pixels: Floats) -> Floats:
        """Give the directions (N, 3) in the robot's frame in which pixels (N, 2) look; their depth is 1."""
        columns = self._robot_from_pixel.T
        return np.asarray(pixels @ columns[:2] + columns[2], np.float64)
