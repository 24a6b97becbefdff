"""Resampling of panoramas into the view for which networks of the panorama sensor were trained."""

from dataclasses import dataclass
from typing import Final, Self

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.sensors.panorama.panorama_view import ALL_ROUND_M, all_round

Linear = NDArray[np.float32]
Image = NDArray[np.uint8]

_SURFACE_M: Final = 3.0  # distance for which centres that are not on the axis are converted exactly
_FLOOR_M: Final = 5.0  # the floor must be visible from here on


@dataclass(frozen=True, slots=True, eq=False)
class Resampling:
    """Conversion of a camera's panoramas to the view `all_round` at the same height.

    Attributes:
        calibration: of the converted images.
        rows: their first row, and the one after the last, that the camera sees; others repeat them.
    """

    calibration: PanoramaCalibration
    rows: tuple[int, int]
    _size: tuple[int, int]
    _columns: Linear
    _lines: Linear

    @classmethod
    def of(cls, camera: PanoramaCalibration) -> Self:
        """Prepare the conversion of a camera's images.

        Raises:
            BadInput: the camera is too low or too high, or the floor is not visible.
        """
        height_m = camera.position_m[2]
        low, high = ALL_ROUND_M
        if not low <= height_m <= high:
            raise BadInput(
                f"panoramic camera: must be {low:g} to {high:g} m above the floor, got {height_m:.2f} m"
            )
        view = all_round(height_m)
        columns, lines = _sources(view, camera)
        is_seen = ((lines >= -0.5) & (lines <= camera.height - 0.5)).all(axis=1)
        seen = np.flatnonzero(is_seen)
        reach_m = view.floor_m(float(seen[-1])) if len(seen) else np.inf
        if not reach_m <= _FLOOR_M:
            raise BadInput(
                f"panoramic camera: must show the floor from {_FLOOR_M:g} m on, got {reach_m:.1f} m; are "
                "its height and its vertical angles right?"
            )
        # Fine images are averaged first, to about the resolution of the view.
        shrink = max(round(camera.width / view.width), 1)
        size = max(camera.width // shrink, 1), max(camera.height // shrink, 1)
        columns = (columns + 0.5) * size[0] / camera.width - 0.5
        lines = np.clip((lines + 0.5) * size[1] / camera.height - 0.5, 0.0, size[1] - 1.0)
        maps = np.asarray(columns, np.float32), np.asarray(lines, np.float32)
        return cls(view, (int(seen[0]), int(seen[-1]) + 1), size, *maps)

    def image(self, panorama: Image) -> Image:
        """Return the converted image (180, 480, 3) of a panorama (H, W, 3)."""
        small = cv2.resize(panorama, self._size, interpolation=cv2.INTER_AREA)
        maps = self._columns, self._lines
        return np.asarray(cv2.remap(small, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP), np.uint8)


def _sources(
    view: PanoramaCalibration, camera: PanoramaCalibration
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the columns and the rows (H, W) of the camera's image that pixels of the view show."""
    v, u = np.mgrid[: view.height, : view.width]
    rays = view.rays(np.column_stack([u.ravel(), v.ravel()]).astype(np.float64))
    rays /= np.hypot(rays[:, :1], rays[:, 1:2])
    columns, lines = camera.project(view.position_m + _SURFACE_M * rays).T
    return columns.reshape(v.shape), np.nan_to_num(lines, nan=-np.inf).reshape(v.shape)
