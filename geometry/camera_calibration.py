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
        """Return the viewing directions (N, 3) of pixels (N, 2) in the robot frame, of any length."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class PinholeCalibration:
    """Calibration of a camera whose image is flat and free of distortion.

    Attributes:
        intrinsics: (3, 3) [px] camera matrix.
        robot_from_camera: (4, 4) pose of the optical frame, x right, y down, z forward, in the robot's.

    Raises:
        BadInput: a matrix has another shape, or contains a number that is not finite.
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
        """Return the viewing directions (N, 3) of pixels (N, 2) in the robot frame, with a depth of 1."""
        columns = self._robot_from_pixel.T
        return np.asarray(pixels @ columns[:2] + columns[2], np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class PanoramaCalibration:
    """Calibration of a panoramic camera on the robot's axis: one with a conical mirror, or equirectangular.

    Each column has one viewing direction. The first column points to the back of the robot; the next ones
    continue over the left, the front and the right to the back. Column numbers wrap around. For each column,
    a mirror acts as a pinhole camera with its centre on a ring around the axis, and with an optical axis that
    points at the lower image border. In an equirectangular image, angles of rows are evenly spaced.

    Attributes:
        width, height: size of the image [px].
        focal_px: focal length of the lens [px]; of an equirectangular image, pixels per radian.
        axis_rad: viewing angle of the lower image border below the horizon [rad].
        ring_radius_m: distance of the centres from the axis, in their viewing direction [m]; may be negative.
        ring_height_m: height of the centres above the floor [m].
        is_equirectangular: whether angles of rows are evenly spaced.

    Raises:
        BadInput: a number is not finite, or the image size or the focal length is invalid.
    """

    width: int
    height: int
    focal_px: float
    axis_rad: float
    ring_radius_m: float
    ring_height_m: float
    is_equirectangular: bool = False

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
        """Return the bearings (N,) of columns, -pi..pi from straight ahead, positive to the left [rad]."""
        turns = 0.5 - (columns + 0.5) / self.width
        return np.asarray(math.tau * (turns - np.rint(turns)), np.float64)

    def depression(self, rows: Floats) -> Floats:
        """Return the viewing angles (N,) of rows below the horizon [rad]."""
        rise = (self.height - 0.5 - rows) / self.focal_px
        above = rise if self.is_equirectangular else np.arctan(rise)
        return np.asarray(self.axis_rad - above, np.float64)

    def floor_m(self, row: float) -> float:
        """Return the distance of the floor in a row [m]; infinite from the horizon upwards."""
        down = float(self.depression(np.array(row)))
        return self.ring_radius_m + self.ring_height_m / math.tan(down) if down > 0.0 else math.inf

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to pixels (N, 2), the column within the image.

        NaN for points that are not in front of the cameras on the ring.
        """
        x, y, z = points_m.T
        above = self.axis_rad - np.arctan2(self.ring_height_m - z, np.hypot(x, y) - self.ring_radius_m)
        if not self.is_equirectangular:
            above = np.tan(np.where(np.abs(above) < math.pi / 2.0, above, np.nan))
        u = (0.5 - np.arctan2(y, x) / math.tau) * self.width - 0.5
        return np.stack([u, self.height - 0.5 - self.focal_px * above], axis=1)

    def row(self, distance_m: float, height_m: float) -> float:
        """Map what is so far away and so high in any direction to its row; NaN as `project` says."""
        above = self.axis_rad - math.atan2(self.ring_height_m - height_m, distance_m - self.ring_radius_m)
        if self.is_equirectangular:
            return self.height - 0.5 - self.focal_px * above
        is_before = abs(above) < math.pi / 2.0
        return self.height - 0.5 - self.focal_px * math.tan(above) if is_before else math.nan

    def rays(self, pixels: Floats) -> Floats:
        """Return the unit viewing directions (N, 3) of pixels (N, 2) in the robot frame.

        The rays start on the ring, whose centre is `position_m` and whose radius is `ring_radius_m`.
        """
        bearing, down = self.bearing(pixels[:, 0]), self.depression(pixels[:, 1])
        level = np.cos(down)
        return np.stack([level * np.cos(bearing), level * np.sin(bearing), -np.sin(down)], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanCalibration:
    """Calibration of a laser range finder, whose scan is an image of one row, from left to right.

    Attributes:
        beams: number of beams.
        step_rad: angle between beams [rad].
        position_m: origin of the beams in the robot's frame [m].
        yaw_rad: direction of the middle of the fan, from the robot's front, positive to the left [rad].

    Raises:
        BadInput: a number is not finite, or there is no beam.
    """

    beams: int
    step_rad: float
    position_m: tuple[float, float, float]
    yaw_rad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse invalid values."""
        numbers = (self.beams, self.step_rad, *self.position_m, self.yaw_rad)
        if not all(map(math.isfinite, numbers)) or self.beams < 1 or self.step_rad <= 0.0:
            raise BadInput(f"calibration: {self.beams} beams, {self.step_rad} rad apart, are invalid")

    @property
    def bearings(self) -> Floats:
        """Directions (N,) of the beams from left to right in the robot's frame, left positive [rad]."""
        right = (np.arange(self.beams) - (self.beams - 1) / 2.0) * self.step_rad
        return np.asarray(self.yaw_rad - right, np.float64)

    def points(self, range_m: Floats) -> Floats:
        """Return the points (N, 2) of a scan with ranges (N,) [m], forward and left in the robot's frame."""
        bearing = self.bearings
        ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
        return np.asarray(self.position_m[:2] + range_m[:, None] * ahead, np.float64)

    def project(self, points_m: Floats) -> Floats:
        """Map points (N, 3) of the robot's frame to the beam and the row (N, 2), which may lie outside."""
        x, y, z = (points_m - np.array(self.position_m)).T
        off = self.yaw_rad - np.arctan2(y, x)
        turns = off / math.tau
        u = math.tau * (turns - np.rint(turns)) / self.step_rad + (self.beams - 1) / 2.0
        return np.stack([u, -np.arctan2(z, np.hypot(x, y)) / self.step_rad], axis=1)

    def rays(self, pixels: Floats) -> Floats:
        """Return the unit directions (N, 3) of beams and rows (N, 2) in the robot's frame."""
        bearing = self.yaw_rad - (pixels[:, 0] - (self.beams - 1) / 2.0) * self.step_rad
        down = pixels[:, 1] * self.step_rad
        level = np.cos(down)
        return np.stack([level * np.cos(bearing), level * np.sin(bearing), -np.sin(down)], axis=1)
