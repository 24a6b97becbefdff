"""Calibrations of cameras: mounting pose on the robot, and viewing ray of each pixel."""

import math
from dataclasses import asdict, dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.small_matrices import inverse

Floats = NDArray[np.float64]


class Calibration(Protocol):
    """Calibration of a camera, which a tracker needs to convert between metres and pixels.

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
        """Return the directions (N, 3) in the robot's frame in which pixels (N, 2) look, of any length."""
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
        """Refuse invalid values."""
        for name, shape in (("intrinsics", (3, 3)), ("robot_from_camera", (4, 4))):
            matrix = getattr(self, name)
            if np.shape(matrix) != shape or not np.isfinite(matrix).all():
                raise BadInput(f"calibration: {name} must be {shape} and finite, got {np.shape(matrix)}")
        unprojected = self.robot_from_camera[:3, :3] @ inverse(self.intrinsics)
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
        """Return the directions (N, 3) in the robot's frame in which pixels (N, 2) look; their depth is 1."""
        columns = self._robot_from_pixel.T
        return np.asarray(pixels @ columns[:2] + columns[2], np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaCalibration:
    """Calibration of a panoramic camera with a cone-shaped mirror over the robot's axis.

    Columns look in one direction each, the first to the robot's back, then by its left, front and right to
    its back again; a column beyond the last one is the first again. In each the mirror makes a pinhole
    camera, whose centre lies on a ring round the axis, and whose own axis looks at the image's lower border.

    Attributes:
        width, height: of the image [px].
        focal_px: of the lens [px].
        axis_rad: how far below the horizon the image's lower border looks [rad].
        ring_radius_m: how far off the axis the centres are, in their direction of view [m]; negative: behind.
        ring_height_m: how far above the floor they are [m].

    Raises:
        BadInput: a number that is not finite, or an image or focal length that is none.
    """

    width: int
    height: int
    focal_px: float
    axis_rad: float
    ring_radius_m: float
    ring_height_m: float

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        for name, value in asdict(self).items():
            if not math.isfinite(value):
                raise BadInput(f"calibration: {name} must be a finite number, got {value}")
        if min(self.width, self.height, self.focal_px) <= 0:
            size = f"{self.width} x {self.height} px"
            raise BadInput(f"calibration: {size} at a focal length of {self.focal_px} px is invalid")

    @property
    def position_m(self) -> tuple[float, float, float]:
        """Middle of the ring in the robot's frame [m]."""
        return 0.0, 0.0, self.ring_height_m

    def bearing(self, columns: Floats) -> Floats:
        """Return where columns (N,) look: -pi..pi from the nose, positive to the left [rad]."""
        turns = 0.5 - (columns + 0.5) / self.width
        return np.asarray(math.tau * (turns - np.rint(turns)), np.float64)

    def depression(self, rows: Floats) -> Floats:
        """Return how far below the horizon rows (N,) look [rad]."""
        return np.asarray(self.axis_rad - np.arctan((self.height - 0.5 - rows) / self.focal_px), np.float64)

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2), the column within the image.

        NaN for those that the ring's cameras do not have before them.
        """
        x, y, z = points_m.T
        above = self.axis_rad - np.arctan2(self.ring_height_m - z, np.hypot(x, y) - self.ring_radius_m)
        radius = self.focal_px * np.tan(np.where(np.abs(above) < math.pi / 2.0, above, np.nan))
        u = (0.5 - np.arctan2(y, x) / math.tau) * self.width - 0.5
        return np.stack([u, self.height - 0.5 - radius], axis=1)

    def row(self, distance_m: float, height_m: float) -> float:
        """Map what is so far away and so high in any direction to its row; NaN as `project` says."""
        above = self.axis_rad - math.atan2(self.ring_height_m - height_m, distance_m - self.ring_radius_m)
        is_before = abs(above) < math.pi / 2.0
        return self.height - 0.5 - self.focal_px * math.tan(above) if is_before else math.nan

    def rays(self, pixels: Floats) -> Floats:
        """Return the unit directions (N, 3) in the robot's frame in which pixels (N, 2) look.

        They start on the ring, which `ring_radius_m` says how to find from `position_m`.
        """
        bearing, down = self.bearing(pixels[:, 0]), self.depression(pixels[:, 1])
        level = np.cos(down)
        return np.stack([level * np.cos(bearing), level * np.sin(bearing), -np.sin(down)], axis=1)
