"""Panoramas of 360-degree cameras: the calibration of each kind of image, and unrolling of round ones."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PanoramaCalibration

Image = NDArray[np.uint8]
Pair = tuple[float, float]

_STEEPEST_DEG: Final = 60.0  # below and above the horizon: what is unrolled of a fisheye image
_WIDEST_PX: Final = 1920


class PanoramaKind(StrEnum):
    """Kind of a 360-degree image."""

    EQUIRECTANGULAR = "equirectangular"
    FISHEYE_UP = "fisheye-up"
    FISHEYE_DOWN = "fisheye-down"
    MIRROR = "mirror"
    UNROLLED = "unrolled"


_USUAL_DEG: Final = {PanoramaKind.FISHEYE_UP: (90.0, 0.0), PanoramaKind.FISHEYE_DOWN: (-90.0, 0.0)}


@dataclass(frozen=True, slots=True, eq=False)
class PanoramaUnrolling:
    """Conversion of 360-degree images to panoramas, whose columns are directions.

    The middle column is the front of the camera. Flat images are not changed. In round images, the front is
    at the top; a camera that looks up, into a mirror or with a fisheye lens, has its left on the right.

    Attributes:
        calibration: of the panoramas; the camera is the origin of positions.
        size: width and height of the images [px].
    """

    calibration: PanoramaCalibration
    size: tuple[int, int]
    _maps: tuple[NDArray[np.float32], NDArray[np.float32]] | None

    @classmethod
    def of(
        cls, kind: PanoramaKind, size: tuple[int, int], elevation_deg: Pair | None, height_m: float
    ) -> Self:
        """Prepare the conversion.

        Args:
            kind: of the images.
            size: width and height of the images [px].
            elevation_deg: elevations of the lower and the upper border of a flat image, or of the centre and
                the rim of a round one; None for the usual ones of this kind.
            height_m: height of the camera above the floor [m].

        Raises:
            BadInput: the elevations are invalid, or unknown.
        """
        begin, end = _elevations(kind, size, elevation_deg)
        if kind in (PanoramaKind.EQUIRECTANGULAR, PanoramaKind.UNROLLED):
            return cls(_calibration(kind, *size, (begin, end), height_m), size, None)
        radius = min(size) / 2.0
        if kind is PanoramaKind.MIRROR:
            rows = round(radius)
            columns = min(4 * rows, _WIDEST_PX)
            return cls._round(
                kind, size, _calibration(kind, columns, rows, (begin, end), height_m), (begin, end)
            )
        steepest = math.radians(_STEEPEST_DEG)
        low, high = max(min(begin, end), -steepest), min(max(begin, end), steepest)
        columns = min(round(math.tau * radius / abs(end - begin)), _WIDEST_PX)
        rows = max(round((high - low) / math.tau * columns), 1)
        return cls._round(kind, size, _calibration(kind, columns, rows, (low, high), height_m), (begin, end))

    @classmethod
    def _round(
        cls, kind: PanoramaKind, size: tuple[int, int], calibration: PanoramaCalibration, elevation: Pair
    ) -> Self:
        """Prepare the unrolling of a round image whose centre and rim have these elevations [rad]."""
        rim = min(size) / 2.0
        rows = np.arange(calibration.height, dtype=np.float64)
        share = (calibration.height - 0.5 - rows) / calibration.height
        if kind is not PanoramaKind.MIRROR:
            share = (-calibration.depression(rows) - elevation[0]) / (elevation[1] - elevation[0])
        bearing = calibration.bearing(np.arange(calibration.width, dtype=np.float64))
        side = -1.0 if kind is PanoramaKind.FISHEYE_DOWN else 1.0
        x = size[0] / 2.0 - 0.5 + side * rim * share[:, None] * np.sin(bearing)
        y = size[1] / 2.0 - 0.5 - rim * share[:, None] * np.cos(bearing)
        return cls(calibration, size, (np.asarray(x, np.float32), np.asarray(y, np.float32)))

    def image(self, picture: Image) -> Image:
        """Return the panorama (H, W, 3) that an image (H', W', 3) shows."""
        if self._maps is None:
            return picture
        unrolled = cv2.remap(picture, *self._maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(unrolled, np.uint8)


def _elevations(kind: PanoramaKind, size: tuple[int, int], given_deg: Pair | None) -> Pair:
    """Return the elevations of both borders [rad]."""
    width, height = size
    if given_deg is None and kind is PanoramaKind.EQUIRECTANGULAR:
        half = 180.0 * height / width  # with square pixels
        given_deg = -half, half
    given_deg = _USUAL_DEG.get(kind) if given_deg is None else given_deg
    if given_deg is None:
        raise BadInput(f"panorama of kind {kind}: needs the elevations of both borders")
    begin, end = given_deg
    is_falling = kind is PanoramaKind.FISHEYE_UP
    least = -90.0 if kind is not PanoramaKind.FISHEYE_UP else -60.0
    if not (
        least <= min(begin, end) and max(begin, end) <= 90.0 and (begin > end if is_falling else begin < end)
    ):
        order = "falling" if is_falling else "rising"
        raise BadInput(
            f"panorama of kind {kind}: elevations must be {order}, from {least:g} to 90 degrees, got "
            f"{begin:g} and {end:g}"
        )
    return math.radians(begin), math.radians(end)


def _calibration(
    kind: PanoramaKind, width: int, height: int, elevation: Pair, height_m: float
) -> PanoramaCalibration:
    """Return the calibration of a panorama whose lower and upper border have these elevations [rad]."""
    low, high = elevation
    is_equirectangular = kind not in (PanoramaKind.MIRROR, PanoramaKind.UNROLLED)
    if not is_equirectangular and high - low >= math.pi / 2.0:
        raise BadInput(f"panorama of kind {kind}: elevations must differ by less than 90 degrees")
    return PanoramaCalibration(
        width=width,
        height=height,
        focal_px=height / (high - low if is_equirectangular else math.tan(high - low)),
        axis_rad=-low,
        ring_radius_m=0.0,
        ring_height_m=height_m,
        is_equirectangular=is_equirectangular,
    )
