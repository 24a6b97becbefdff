"""The interface of all camera geometries, and the pinhole camera."""

import dataclasses
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.settings import IN_DEGREES, Position

Matrix = NDArray[np.float64]

# Columns: the optical axes (right, down, forward) in a frame with x forward, y left, z up.
_BODY_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Pinhole:
    """A distortion-free camera with square pixels, fixed to the robot.

    Image frame: u right, v down, origin at the centre of the top-left pixel, so that the image spans
    -0.5 .. width - 0.5. Optical frame: x right, y down, z forward.
    """

    width: Annotated[int, Field(ge=16, le=4096, alias="width_px", description="width of the image")] = 320
    height: Annotated[int, Field(ge=16, le=4096, alias="height_px", description="height of the image")] = 240
    vertical_fov_rad: Annotated[
        float, IN_DEGREES, Field(ge=5.0, le=150.0, description="vertical field of view")
    ] = math.radians(44.0)
    position_m: Annotated[
        Position,
        Field(
            alias="mount_m",
            description="optical centre in the robot frame: forward, left, and up from the floor",
        ),
    ] = (0.14, 0.0, 1.2)
    pitch_rad: Annotated[
        float, IN_DEGREES, Field(ge=-90.0, le=90.0, description="pitch; positive values point down")
    ] = 0.0
    yaw_rad: Annotated[
        float, IN_DEGREES, Field(ge=-180.0, le=180.0, description="yaw; positive values point left")
    ] = 0.0

    @property
    def focal_px(self) -> float:
        """Focal length [px]."""
        return self.height / 2.0 / math.tan(self.vertical_fov_rad / 2.0)

    @property
    def centre_px(self) -> tuple[float, float]:
        """Principal point (u, v) [px]: the middle of the image."""
        return (self.width - 1) / 2.0, (self.height - 1) / 2.0

    @property
    def intrinsics(self) -> Matrix:
        """(3, 3) [px] camera matrix."""
        u, v = self.centre_px
        return np.array([[self.focal_px, 0.0, u], [0.0, self.focal_px, v], [0.0, 0.0, 1.0]])

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        return _robot_from_camera(self)

    @property
    def calibration(self) -> PinholeCalibration:
        """Calibration of the camera for a tracker."""
        return _calibration(self)

    def project(self, camera_points: Matrix) -> Matrix:
        """Project points of the optical frame to the image.

        Args:
            camera_points: (..., 3) [m] x right, y down, z forward.

        Returns:
            (..., 2) [px] u, v; NaN for points that are not in front of the camera.
        """
        z = np.where(camera_points[..., 2] > 1e-9, camera_points[..., 2], np.nan)
        u, v = self.centre_px
        return np.stack(
            [self.focal_px * camera_points[..., 0] / z + u, self.focal_px * camera_points[..., 1] / z + v],
            axis=-1,
        )


@lru_cache(maxsize=16)
def _robot_from_camera(camera: Pinhole) -> Matrix:
    cy, sy = math.cos(camera.yaw_rad), math.sin(camera.yaw_rad)
    cp, sp = math.cos(camera.pitch_rad), math.sin(camera.pitch_rad)
    yaw = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    pitch = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    pose = np.eye(4)
    pose[:3, :3] = yaw @ pitch @ _BODY_FROM_OPTICAL
    pose[:3, 3] = camera.position_m
    pose.setflags(write=False)
    return pose


@lru_cache(maxsize=16)
def _calibration(camera: Pinhole) -> PinholeCalibration:
    return PinholeCalibration(camera.intrinsics, camera.robot_from_camera)


def invert_pose(pose: Matrix) -> Matrix:
    """Invert a rigid (4, 4) pose: a_from_b to b_from_a."""
    inverse = np.zeros((4, 4))
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -inverse[:3, :3] @ pose[:3, 3]
    inverse[3, 3] = 1.0
    return inverse


def transform(pose: Matrix, points: Matrix) -> Matrix:
    """Map (..., 3) points by a rigid (4, 4) pose."""
    return points @ pose[:3, :3].T + pose[:3, 3]


class CameraGeometry(Protocol):
    """Size and mounting of a camera, and its projection.

    It is a frozen dataclass with the fields `width` and `height`. Image and optical frame are as in
    `Pinhole`; code that needs more, such as a focal length, requires a `Pinhole`.
    """

    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    @property
    def width(self) -> int:
        """[px] columns of the image."""
        ...

    @property
    def height(self) -> int:
        """[px] rows of the image."""
        ...

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        ...

    @property
    def calibration(self) -> Calibration | None:
        """Calibration of the camera for a tracker; None if trackers do not support the geometry."""
        ...

    def project(self, camera_points: Matrix) -> Matrix:
        """Project (..., 3) points [m] of the optical frame: (..., 2) [px] u, v; NaN where none is."""
        ...

    def __hash__(self) -> int:
        """Equal geometries see the same, which is drawn once."""
        ...
