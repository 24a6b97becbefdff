"""Geometry of a laser range finder: the beams of a horizontal fan, as an image of one row."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, ClassVar, Final

import numpy as np
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.settings import IN_DEGREES, Position
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole

_WHOLE: Final = 1e-6  # tolerance of a whole number of steps


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanPlane:
    """A fan of equally spaced beams in a plane parallel to the floor, fixed to the robot.

    Image frame: one row, with a pixel per beam from left to right, so that u is right as in `Pinhole`; v is
    the angle below the plane, in steps. Optical frame: x right, y down, z to the middle of the fan.

    Raises:
        BadInput: 360 degrees and the field of view are not whole numbers of steps, both even or both odd.
    """

    height: ClassVar[int] = 1

    fov_rad: Annotated[
        float, IN_DEGREES, Field(ge=5.0, le=360.0, description="field of view of the fan of beams")
    ] = math.pi
    step_rad: Annotated[
        float,
        IN_DEGREES,
        Field(
            ge=0.1,
            le=5.0,
            description="angle between beams: 360 degrees and `fov_deg` must be whole numbers of steps, both "
            "even or both odd",
        ),
    ] = math.radians(0.5)
    position_m: Annotated[
        Position,
        Field(
            alias="mount_m",
            description="origin of the beams in the robot frame: forward, left, and up from the floor",
        ),
    ] = (0.22, 0.0, 0.3)
    yaw_rad: Annotated[
        float, IN_DEGREES, Field(ge=-180.0, le=180.0, description="yaw; positive values point left")
    ] = 0.0

    def __post_init__(self) -> None:
        """Refuse a step that does not fit into a turn and into the field of view."""
        step_deg, fov_deg = math.degrees(self.step_rad), math.degrees(self.fov_rad)
        steps = 360.0 / step_deg, fov_deg / step_deg
        is_whole = all(abs(one - round(one)) < _WHOLE for one in steps)
        if not is_whole or (round(steps[0]) - round(steps[1])) % 2:
            raise BadInput(
                f"{step_deg:g}: 360 and fov_deg, {fov_deg:g}, must be whole numbers of steps, both even or "
                "both odd, as with 0.5 or 1",
                key=("step_deg",),
            )

    @property
    def width(self) -> int:
        """Number of beams."""
        return round(self.fov_rad / self.step_rad)

    @property
    def beams_per_turn(self) -> int:
        """Number of beams in 360 degrees."""
        return round(math.tau / self.step_rad)

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        return Pinhole(position_m=self.position_m, yaw_rad=self.yaw_rad).robot_from_camera

    @property
    def calibration(self) -> ScanCalibration:
        """Calibration of the range finder for a tracker."""
        return _calibration(self)

    def project(self, camera_points: Matrix) -> Matrix:
        """Project points of the optical frame to the image.

        Args:
            camera_points: (..., 3) [m] x right, y down, z forward.

        Returns:
            (..., 2) [px] u, v; both may lie outside the image.
        """
        x, y, z = np.moveaxis(camera_points, -1, 0)
        u = (np.arctan2(x, z) + self.fov_rad / 2.0) / self.step_rad - 0.5
        return np.stack([u, np.arctan2(y, np.hypot(x, z)) / self.step_rad], axis=-1)


@lru_cache(maxsize=16)
def _calibration(plane: ScanPlane) -> ScanCalibration:
    return ScanCalibration(
        beams=plane.width, step_rad=plane.step_rad, position_m=plane.position_m, yaw_rad=plane.yaw_rad
    )
