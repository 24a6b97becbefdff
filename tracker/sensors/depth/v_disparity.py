"""Detection of floor and ceiling as oblique lines in the v-disparity image."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.depth.depth_view import BASELINE_M, Depth, DepthView

Counts = NDArray[np.int32]

BIN_PX: Final = 0.25
_BINS: Final = 512
_MOST: Final = 80  # limit of the readings of a cell, lest a wall outweighs the floor
_LEAST_VOTES: Final = 400.0
_ROWS_PER_BIN: Final = BIN_PX / BASELINE_M  # slope of a line for each metre below the camera
_SHIFT_PX: Final = 16.0
_FLOOR_M: Final = (0.3, 2.4)  # range of the camera's height above the floor
_NEAREST_FLOOR_M: Final = 6.0  # depth of the floor in the last row, from which the floor is not searched for
_STEEPEST_RAD: Final = math.radians(45.0)
_TOLERANCES_M: Final = (0.12, 0.08, 0.05, 0.05)
_LEAST_SPREAD: Final = 0.06  # standard deviation of depths by their mean
_CEILING_M: Final = (-3.2, -0.7)


@dataclass(frozen=True, slots=True)
class HeightLine:
    """A horizontal plane whose height is linear in depth: y = slope z + offset_m (SA eq. 4.10), y down.

    Attributes:
        slope: [m/m] descent with depth.
        offset_m: [m] below the camera at depth 0, negative for above.
    """

    slope: float
    offset_m: float

    def rows(self, depth_m: Floats, view: DepthView) -> Floats:
        """Return the image rows [px] of the plane at depths [m]."""
        return np.asarray(view.centre_v + view.focal_px * (self.slope + self.offset_m / depth_m))

    def raised(self, height_m: float) -> "HeightLine":
        """Return the plane raised by a height."""
        return HeightLine(self.slope, self.offset_m - height_m)


def v_disparity(depth: Depth, view: DepthView) -> Counts:
    """Count the readings (H, D) of each row by disparity, in bins of a quarter pixel (SA eq. 4.8)."""
    return _histogram(depth, _bin_of_mm(view.disparity_px_m))


def find_floor(counts: Counts, view: DepthView) -> HeightLine | None:
    """Return the line of the floor by a Hough vote over height and horizon, or None.

    None, too, if the image shows the floor from afar only: the vote would find another line.

    Args:
        counts: from `v_disparity`.
        view: geometry of the image.
    """
    lowest = (len(counts) - 0.5 - view.centre_v - view.horizon_px) / view.focal_px
    if view.height_m > _NEAREST_FLOOR_M * lowest:
        return None
    return _strongest(counts, view, *_FLOOR_M, _SHIFT_PX)


def estimate_camera_pose(depths: Iterable[Depth], view: DepthView) -> tuple[float, float] | None:
    """Return height above the floor [m] and pitch [rad] of a camera, positive down, from its depth images.

    The medians over the images in which a floor is found; None if it is in fewer than half of them.
    """
    widest_px = view.focal_px * math.tan(_STEEPEST_RAD)
    fitted = []
    for depth in depths:
        line = _strongest(v_disparity(depth, view), view, *_FLOOR_M, widest_px)
        fitted.append(None if line is None else _fit_line(line, depth, view))
    floors = [one for one in fitted if one is not None]
    if not floors or 2 * len(floors) < len(fitted):
        return None
    slope, offset_m = np.median([(one.slope, one.offset_m) for one in floors], axis=0).tolist()
    return offset_m / math.hypot(1.0, slope), -math.atan(slope)


def _fit_line(line: HeightLine, depth: Depth, view: DepthView) -> HeightLine | None:
    """Fit a line to the readings of a depth image near it, by least squares; None if it is of a wall.

    A vote is too coarse if the floor is only seen far away.
    """
    z_m = depth[depth > 0] / 1000.0
    y_m = (np.nonzero(depth)[0] - view.centre_v) * z_m / view.focal_px
    for tolerance_m in _TOLERANCES_M:
        is_near = np.abs(y_m - line.slope * z_m - line.offset_m) < tolerance_m
        if not is_near.any() or np.std(z_m[is_near]) < _LEAST_SPREAD * np.mean(z_m[is_near]):
            return None
        line = HeightLine(*np.polyfit(z_m[is_near], y_m[is_near], 1).tolist())
    return line


def find_ceiling(counts: Counts, view: DepthView) -> HeightLine | None:
    """Return the line of the ceiling by the same vote, or None."""
    return _strongest(counts, view, *_CEILING_M, _SHIFT_PX)


def _strongest(
    counts: Counts, view: DepthView, lowest_m: float, highest_m: float, shift_px: float
) -> HeightLine | None:
    """Return the line with the most votes; its slope is the horizon's shift in focal lengths (4.11)."""
    horizon = view.centre_v + view.horizon_px
    heights = np.arange(lowest_m, highest_m, 0.04)
    rows = horizon + np.arange(-shift_px, shift_px + 1.0, 2.0)
    votes = _hough(counts, rows, heights * _ROWS_PER_BIN, 2)
    best, row = np.unravel_index(int(np.argmax(votes)), votes.shape)
    if votes[best, row] < _LEAST_VOTES:
        return None
    return _refined(counts, float(rows[row]), float(heights[best]), view)


def _refined(counts: Counts, row: float, height_m: float, view: DepthView) -> HeightLine:
    """Repeat the vote near a line, on every row, in finer steps."""
    rows, heights = row + np.arange(-3.0, 3.25, 0.5), height_m + np.arange(-0.06, 0.065, 0.01)
    votes = _hough(counts, rows, heights * _ROWS_PER_BIN, 1)
    best, nearest = np.unravel_index(int(np.argmax(votes)), votes.shape)
    return HeightLine((float(rows[nearest]) - view.centre_v) / view.focal_px, float(heights[best]))


@lru_cache(maxsize=8)
def _bin_of_mm(disparity_px_m: float) -> NDArray[np.int16]:
    """Tabulate the disparity bin of each depth [mm]; -1 for none."""
    depth_m = np.arange(1 << 16) / 1000.0
    with np.errstate(divide="ignore"):
        bins = np.round(disparity_px_m / depth_m / BIN_PX)
    return np.where((bins > 0) & (bins < _BINS), bins, -1.0).astype(np.int16)


@njit(cache=True, nogil=True)
def _histogram(depth: Depth, bin_of_mm: NDArray[np.int16]) -> Counts:
    height, width = depth.shape
    counts = np.zeros((height, _BINS), np.int32)
    for v in range(height):
        for u in range(width):
            place = bin_of_mm[depth[v, u]]
            if place >= 0:
                counts[v, place] += 1
    return counts


@njit(cache=True, nogil=True)
def _hough(counts: Counts, horizons: Floats, rows_per_bin: Floats, stride: int) -> Floats:
    """Vote (heights, horizons) for lines through a horizon row with a slope in rows per bin."""
    rows = counts.shape[0]
    votes = np.zeros((len(rows_per_bin), len(horizons)))
    for h in range(len(rows_per_bin)):
        for b in range(len(horizons)):
            total = 0
            first = horizons[b]
            for v in range(0, rows, stride):
                place = int((v - first) / rows_per_bin[h] + 0.5)
                if 0 < place < _BINS:
                    total += min(counts[v, place], _MOST)
            votes[h, b] = total * stride
    return votes
