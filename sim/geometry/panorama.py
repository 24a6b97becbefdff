"""Panoramic camera geometry: which way the pixels of an unrolled image look, and where points fall in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.mirror import Mirror
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole


@dataclass(frozen=True, slots=True, kw_only=True)
class Panorama:
    """The unrolled image of a cone-shaped mirror over the robot's axis.

    Image frame as in `Pinhole`: each column looks in one direction, from the robot's back at the left border
    by its left, front and right to its back again; rows are the rings of the lens's image, its middle at the
    bottom, and the bottom is the lowest view. Optical frame: the middle of the ring of `Mirror`, x to the
    robot's right, y down, z to its front.

    Attributes:
        width: [px] round the lens's image.
        height: [px] from its middle to its rim.
        mirror: what it sees by.
    """

    width: int = 480
    height: int = 120
    mirror: Mirror = field(default_factory=Mirror)

    @property
    def focal_px(self) -> float:
        """[px] focal length of the lens."""
        return self.height / math.tan(self.mirror.lens_half_angle_rad)

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        return Pinhole(position_m=(0.0, 0.0, self.mirror.ring_height_m)).robot_from_camera

    def bearing(self, columns: ArrayLike) -> Matrix:
        """[rad] where columns look, from the robot's nose, positive to the left."""
        return np.asarray(math.pi - math.tau * (np.asarray(columns) + 0.5) / self.width, np.float64)

    def depression(self, rows: ArrayLike) -> Matrix:
        """[rad] how far below the horizon rows look."""
        radius = self.height - 0.5 - np.asarray(rows, np.float64)
        return np.asarray(self.mirror.axis_rad - np.arctan(radius / self.focal_px), np.float64)

    def project(self, camera_points: Matrix) -> Matrix:
        """Project points of the optical frame to the image.

        Args:
            camera_points: (..., 3) [m] x right, y down, z forward.

        Returns:
            (..., 2) [px] u, v; rows may lie outside the image; NaN for points that no lens could see.
        """
        x, y, z = np.moveaxis(camera_points, -1, 0)
        u = (np.arctan2(x, z) / math.tau + 0.5) * self.width - 0.5
        above = self.mirror.axis_rad - np.arctan2(y, np.hypot(x, z) - self.mirror.ring_radius_m)
        radius = self.focal_px * np.tan(np.where(np.abs(above) < math.pi / 2.0, above, np.nan))
        return np.stack([u, self.height - 0.5 - radius], axis=-1)


def around_px(camera: CameraGeometry) -> float:
    """[px] how many columns go all round; inf for an image that has borders at its sides."""
    return float(camera.width) if isinstance(camera, Panorama) else math.inf
