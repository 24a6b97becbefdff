"""Detection of walls as straight lines in the u-disparity image, and their removal from the depth image."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import fit_line
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.depth.depth_view import Depth, DepthView
from peopleboy.tracker.sensors.depth.u_depth import FARTHEST_M, NEAREST_M, STEP_1_M

_EVERY_U: Final = 4  # only every so many columns are used
_EVERY_V: Final = 2
_LEAST_READINGS: Final = 4  # in a column, to indicate a tall object
_OFF_PX: Final = 0.2  # tolerance of a column's disparity
_LEAST_COLUMNS: Final = 10  # of the used columns
_LEAST_M: Final = 0.8  # length of a wall
_MOST_WALLS: Final = 6
_MOST_SCATTER_PX: Final = 0.12  # half of the range of eight tenths of a column's readings
_SPANS: Final = (6, 16, 40)  # distances between the two columns of a line hypothesis
_CORNER_PX: Final = 12  # extension of a wall beyond its certain columns
_BEHIND_M: Final = FARTHEST_M + 1.0  # the near fringe of farther objects is out of reach
_STEPS: Final = 1.1  # tolerance of a wall's readings in steps of the sensor


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthWall:
    """A vertical plane: disparity is linear in the column.

    Attributes:
        slope: disparity by column [px/px].
        offset_px: disparity at the principal point [px].
        left, right: first and last column in which it is visible above people's heads [px].
    """

    slope: float
    offset_px: float
    left: int
    right: int

    def disparity(self, columns: Floats, view: DepthView) -> Floats:
        """Return the disparity [px] in columns; not positive where they do not meet the plane."""
        return np.asarray(self.offset_px + self.slope * (columns - view.centre_u))

    def depth_m(self, columns: Floats, view: DepthView) -> Floats:
        """Return the depth [m] in columns; at least 1000 m where they do not meet the plane."""
        disparity = np.maximum(self.disparity(columns, view), view.disparity_px_m / 1000.0)
        return np.asarray(view.disparity_px_m / disparity)

    def square_px(self, view: DepthView) -> float:
        """Return the disparity [px] of the plane for a camera that faces it."""
        return float(np.hypot(self.slope * view.focal_px, self.offset_px))


def tall_disparity(
    depth: Depth, first_row: Floats, last_row: Floats, row_m: float, view: DepthView
) -> Floats:
    """Return the disparity (W, 2) [px] of objects above people's heads, NaN for none.

    The first is the median, the second half of the range of eight tenths of the readings. Only every fourth
    column of the image is used.

    Args:
        depth: (H, W) [mm].
        first_row: (D,) [px] first image row below the ceiling at each depth.
        last_row: (D,) [px] last image row above people's heads.
        row_m: [m] of depth in a row.
        view: of the camera.
    """
    limits = [np.clip(rows, -1.0, depth.shape[0]) for rows in (first_row, last_row)]
    return _middle(depth, limits[0], limits[1], round(1000.0 * row_m), 1000.0 * view.disparity_px_m)


def find_walls(tall: Floats, view: DepthView) -> tuple[DepthWall, ...]:
    """Return the lines through most columns (W, 2) of disparities, the longest first.

    Returns none if readings scatter too much, as removing them would leave fragments of human size.
    """
    columns = np.flatnonzero(np.isfinite(tall[:, 0]))
    walls: list[DepthWall] = []
    if not len(columns) or np.median(tall[columns, 1]) > _MOST_SCATTER_PX:
        return ()
    while len(columns) >= _LEAST_COLUMNS and len(walls) < _MOST_WALLS:
        u, disparity = np.asarray(columns - view.centre_u, np.float64), tall[columns, 0]
        on = _strongest(u, disparity)
        if np.count_nonzero(on) < _LEAST_COLUMNS:
            break
        slope, offset = fit_line(u[on], disparity[on])
        left, right = columns[on][[0, -1]].tolist()
        walls.append(DepthWall(slope=slope, offset_px=offset, left=left, right=right))
        columns = columns[~on & (np.abs(offset + slope * u - disparity) >= _OFF_PX)]
    return tuple(wall for wall in walls if _length_m(wall, view) >= _LEAST_M)


def bands_mm(
    walls: tuple[DepthWall, ...], tall: Floats, off_m: float, view: DepthView
) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """Return the nearest and the farthest depth (K, W) [mm] of each wall by column; 0 and 0 outside it.

    A wall extends over the columns in which it is visible above people's heads, slightly beyond them, as
    corners are frayed, and over adjacent columns without tall objects.

    Args:
        walls: detected walls.
        tall: (W, 2) [px] disparities from which they were detected.
        off_m: [m] tolerance perpendicular to a wall.
        view: of the camera.
    """
    limits = np.zeros((2, len(walls), len(tall)))
    columns = np.arange(len(tall), dtype=np.float64)
    looked = np.flatnonzero(np.isfinite(tall[:, 0]))
    apart = np.abs(looked[:, None] - columns)  # (L, W)
    for k, wall in enumerate(walls):
        shows = np.abs(wall.disparity(columns[looked], view) - tall[looked, 0]) < _OFF_PX
        depth_m = wall.depth_m(columns, view)
        here = shows[apart.argmin(axis=0)] | (apart[shows].min(axis=0) <= _CORNER_PX)
        here &= (depth_m > NEAREST_M) & (depth_m < _BEHIND_M)
        along_ray_m = off_m * wall.square_px(view) * depth_m / view.disparity_px_m
        reach = along_ray_m + _STEPS * STEP_1_M * depth_m**2
        limits[:, k, here] = np.stack([depth_m - reach, depth_m + reach])[:, here]
    near, far = np.clip(1000.0 * limits, 0.0, 65535.0).astype(np.uint16)
    return near, far


def _length_m(wall: DepthWall, view: DepthView) -> float:
    ends = np.array([wall.left, wall.right], np.float64)
    z = wall.depth_m(ends, view)
    return float(np.hypot(np.diff((ends - view.centre_u) * z / view.focal_px), np.diff(z))[0])


def _strongest(u: Floats, disparity: Floats) -> NDArray[np.bool_]:
    slope, offset = _try_lines(u, disparity, np.array(_SPANS))
    return np.asarray(np.abs(offset + slope * u - disparity) < _OFF_PX)


@njit(cache=True, nogil=True)
def without(depth: Depth, near_mm: NDArray[np.uint16], far_mm: NDArray[np.uint16]) -> Depth:
    """Remove the readings (H, W) within any of each column's limits (K, W)."""
    kept = depth.copy()
    for k in range(len(near_mm)):
        near, far = near_mm[k], far_mm[k]
        for v in range(depth.shape[0]):
            for u in range(depth.shape[1]):
                if near[u] <= kept[v, u] <= far[u]:
                    kept[v, u] = 0
    return kept


@njit(cache=True, nogil=True)
def _try_lines(u: Floats, disparity: Floats, spans: NDArray[np.int64]) -> tuple[float, float]:
    """Return slope and offset of the line through two columns that most columns support."""
    most, best = -1, (0.0, 0.0)
    for span in spans:
        for first in range(0, len(u) - span, 2):
            last = first + span
            slope = (disparity[last] - disparity[first]) / (u[last] - u[first])
            offset = disparity[first] - slope * u[first]
            count = 0
            for k in range(len(u)):
                if abs(offset + slope * u[k] - disparity[k]) < _OFF_PX:
                    count += 1
            if count > most:
                most, best = count, (slope, offset)
    return best


@njit(cache=True, nogil=True)
def _middle(depth: Depth, first_row: Floats, last_row: Floats, row_mm: int, disparity_px_mm: float) -> Floats:
    height, width = depth.shape
    middle = np.full((width, 2), np.nan)
    found = np.empty(height, np.uint16)
    lowest = min(height - 1, int(last_row.max()))
    for u in range(0, width, _EVERY_U):
        count = 0
        for v in range(0, lowest + 1, _EVERY_V):
            reading = depth[v, u]
            row = reading // row_mm
            if reading > 0 and row < len(first_row) and first_row[row] <= v <= last_row[row]:
                found[count] = reading
                count += 1
        if count >= _LEAST_READINGS:
            readings = np.sort(found[:count])
            middle[u, 0] = disparity_px_mm / readings[count // 2]
            nearest, farthest = readings[count // 10], readings[count - 1 - count // 10]
            middle[u, 1] = 0.5 * (disparity_px_mm / nearest - disparity_px_mm / farthest)
    return middle
