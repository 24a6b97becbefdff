"""Panoramic camera geometry: viewing rays of an unrolled image, and projection into it."""

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.settings import IN_DEGREES, ByName
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix, Pinhole

# The cone-shaped mirror of a panoramic camera: how high and how far off the axis it makes a camera see.


@dataclass(frozen=True, slots=True, kw_only=True)
class Mirror:
    """The mirror of a panoramic camera: a cone with its apex down, above a lens that points straight up.

    In each direction the mirror's line is straight, so it shows what a camera without a mirror would see from
    the lens's mirror image. These images form a ring, whose cameras look outwards and down by `axis_rad`; the
    ray that the lens sees at an angle t off its own axis leaves them t higher.

    Source: Baker and Nayar, A theory of single-viewpoint catadioptric image formation, IJCV 35, 175 (1999),
    section 3.1.1; their ring has another radius, which the law of reflection does not give.

    Raises:
        BadInput: the lens sees past the mirror, or the mirror shows no floor or something that is no number.
    """

    half_apex_rad: Annotated[
        float,
        IN_DEGREES,
        Field(gt=45.0, le=89.0, description="angle between the axis of the cone and its surface"),
    ] = math.radians(72.5)
    lens_half_angle_rad: Annotated[
        float,
        IN_DEGREES,
        Field(
            gt=0.0,
            le=85.0,
            description="angle between the optical axis of the lens and the rim of its image, where the "
            "view is highest",
        ),
    ] = math.radians(47.0)
    lens_m: Annotated[
        float, Field(gt=0.0, le=1.0, description="distance between the lens and the tip of the cone above it")
    ] = 0.04
    apex_m: Annotated[
        float, Field(gt=0.0, le=10.0, description="height of the tip of the cone above the floor")
    ] = 1.68

    def __post_init__(self) -> None:
        """Refuse a mirror that cannot be used."""
        apex, lens = math.degrees(self.half_apex_rad), math.degrees(self.lens_half_angle_rad)
        if not 45.0 < apex < 90.0:
            raise BadInput(f"half_apex_deg {apex:g}: must be 45 to 90 for a cone that shows the floor")
        if not 0.0 < lens < apex:
            raise BadInput(
                f"lens_half_angle_deg {lens:g}: must be above 0, and below half_apex_deg, {apex:g}"
            )
        if not (self.lens_m > 0.0 and self.apex_m > self.lens_m and math.isfinite(self.apex_m)):
            raise BadInput(f"lens_m {self.lens_m:g}: must be above 0, and below apex_m, {self.apex_m:g}")

    @property
    def axis_rad(self) -> float:
        """[rad] below the horizon: the lowest view, which the lens sees in the middle of its image."""
        return 2.0 * self.half_apex_rad - math.pi / 2.0

    @property
    def ring_radius_m(self) -> float:
        """[m] distance of the ring's cameras from the axis in the direction of view; negative: behind it."""
        return -self.lens_m * math.sin(2.0 * self.half_apex_rad)

    @property
    def ring_height_m(self) -> float:
        """[m] height of the ring above the floor."""
        return self.apex_m - self.lens_m * math.cos(2.0 * self.half_apex_rad)


MIRRORS = {
    "default": Mirror(),
    "narrow": Mirror(
        half_apex_rad=math.radians(62.5), lens_half_angle_rad=math.radians(27.0), lens_m=0.08, apex_m=1.66
    ),
}
"""Mirrors by name: the usual one shows 55 to 8 degrees below the horizon, the narrow one 35 to 8."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Panorama:
    """The unrolled image of a cone-shaped mirror over the robot's axis.

    Image frame as in `Pinhole`: each column looks in one direction, from the robot's back at the left border
    by its left, front and right to its back again; rows are the rings of the lens's image, its middle at the
    bottom, and the bottom is the lowest view. Optical frame: the middle of the ring of `Mirror`, x to the
    robot's right, y down, z to its front.
    """

    width: Annotated[
        int, Field(ge=16, le=4096, alias="width_px", description="width of the image, over 360 degrees")
    ] = 480
    height: Annotated[
        int,
        Field(
            ge=16,
            le=4096,
            alias="height_px",
            description="height of the image, from the centre of the lens image to its rim",
        ),
    ] = 120
    mirror: Annotated[
        Mirror,
        ByName(MIRRORS),
        Field(
            description="mirror: `default` covers 8 to 55 degrees below the horizon, `narrow` covers 8 "
            "to 35 degrees, and a mapping defines another mirror"
        ),
    ] = field(default_factory=Mirror)

    @property
    def focal_px(self) -> float:
        """[px] focal length of the lens."""
        return self.height / math.tan(self.mirror.lens_half_angle_rad)

    @property
    def robot_from_camera(self) -> Matrix:
        """(4, 4) optical frame to robot frame; read-only."""
        return Pinhole(position_m=(0.0, 0.0, self.mirror.ring_height_m)).robot_from_camera

    @property
    def calibration(self) -> PanoramaCalibration:
        """Calibration of the camera for a tracker."""
        return _calibration(self)

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


@lru_cache(maxsize=16)
def _calibration(camera: Panorama) -> PanoramaCalibration:
    return PanoramaCalibration(
        width=camera.width,
        height=camera.height,
        focal_px=camera.focal_px,
        axis_rad=camera.mirror.axis_rad,
        ring_radius_m=camera.mirror.ring_radius_m,
        ring_height_m=camera.mirror.ring_height_m,
    )


def around_px(camera: CameraGeometry) -> float:
    """[px] how many columns go all round; inf for an image that has borders at its sides."""
    return float(camera.width) if isinstance(camera, Panorama) else math.inf
