"""View from above: readings by depth and column, and their connected components."""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.depth.depth_view import Depth

Ints = NDArray[np.int32]

NEAREST_M: Final = 0.5
FARTHEST_M: Final = 10.0
STEP_1_M: Final = 0.00287  # depth step of the sensor at 1 m; grows with the square
_LEAST_PX: Final = 10  # SA 4.4.1: cells with more readings are kept
_LEAST_MASS: Final = 100
# What is farther may be the near fringe of a wall out of the sensor's range; unlikely without walls.
_FRINGE_M: Final = 9.7
_FRINGE_WITHOUT_WALLS_M: Final = 9.9
# SA 4.4.1: gaps of 2, 4, 6 or 10 rows are bridged; where each begins is not printed.
_ZONES_M: Final = np.array([2.6, 3.7, 4.6])
_GAPS: Final = np.array([2, 4, 6, 10])


@dataclass(frozen=True, slots=True)
class DepthPiece:
    """One connected component of the view from above.

    Attributes:
        left, right: first and last column [px], without the outermost of its readings.
        near_m, far_m: first and last depth [m], likewise trimmed.
        depth_m: mean of its readings.
        mass: number of them.
    """

    left: int
    right: int
    near_m: float
    far_m: float
    depth_m: float
    mass: int


@dataclass(frozen=True, slots=True)
class UDepthConfig:
    """Settings of the view from above.

    Attributes:
        row_m: [m] of depth in a row.
        has_connector: whether gaps in depth are bridged, wider ones farther away.
        bridged_steps: [steps of the sensor] least length of a bridged gap; beyond 8 m the printed gaps are
            narrower than one step, and components fall apart.
        trimmed: share of a component's readings left out at either end of its extents.
        has_walls: whether walls are detected as planes and removed, so that people next to one stay separate.
        wall_m: [m] perpendicular distance from a wall within which readings belong to it.
    """

    row_m: float = 0.02
    has_connector: bool = True
    bridged_steps: float = 1.2
    trimmed: float = 0.015
    has_walls: bool = True
    wall_m: float = 0.1


def u_depth(depth: Depth, first_row: Floats, last_row: Floats, row_m: float) -> Ints:
    """Count readings (D, W) by depth and column.

    Args:
        depth: (H, W) [mm].
        first_row: (D,) [px] first image row below the ceiling at each depth.
        last_row: (D,) [px] last image row above the floor.
        row_m: [m] of depth in a row.
    """
    limits = [np.clip(rows, -1.0, depth.shape[0]) for rows in (first_row, last_row)]
    return _count(depth, limits[0], limits[1], round(1000.0 * row_m))


def depths_m(row_m: float) -> Floats:
    """Return the middle (D,) of each row's depths [m]."""
    return np.asarray((np.arange(round(FARTHEST_M / row_m) + 1) + 0.5) * row_m)


def find_pieces(counts: Ints, config: UDepthConfig) -> tuple[DepthPiece, ...]:
    """Return the connected components, the nearest first."""
    kept = (counts > _LEAST_PX).astype(np.uint8)
    if config.has_connector:
        _connect(kept, gaps(config))
    number, labels, boxes, _ = cv2.connectedComponentsWithStats(kept, connectivity=8, ltype=cv2.CV_32S)
    rows = _extents(counts, np.asarray(labels, np.int32), np.array(boxes, np.int32), number, config.trimmed)
    found = [_piece(row, config.row_m) for row in rows.tolist()]
    fringe_m = _FRINGE_WITHOUT_WALLS_M if config.has_walls else _FRINGE_M
    likely = [one for one in found if one.mass >= _LEAST_MASS and one.depth_m < fringe_m]
    return tuple(sorted(likely, key=lambda piece: piece.depth_m))


def _piece(row: list[float], row_m: float) -> DepthPiece:
    left, right, near, far, mean, mass = row
    return DepthPiece(int(left), int(right), near * row_m, (far + 1.0) * row_m, mean * row_m, int(mass))


def gaps(config: UDepthConfig) -> Ints:
    """Return the gaps (D,) in rows that are bridged behind each row."""
    depth_m = depths_m(config.row_m)
    printed = _GAPS[np.searchsorted(_ZONES_M, depth_m)]
    steps = np.round(config.bridged_steps * STEP_1_M * depth_m**2 / config.row_m)
    return np.asarray(np.maximum(printed, steps), np.int32)


@njit(cache=True, nogil=True)
def _count(depth: Depth, first_row: Floats, last_row: Floats, row_mm: int) -> Ints:
    height, width = depth.shape
    counts = np.zeros((len(first_row), width), np.int32)
    for v in range(height):
        for u in range(width):
            reading = depth[v, u]
            if reading == 0:
                continue
            row = reading // row_mm
            if row < len(first_row) and first_row[row] <= v <= last_row[row]:
                counts[row, u] += 1
    return counts


@njit(cache=True, nogil=True)
def _connect(kept: NDArray[np.uint8], gap: Ints) -> None:
    """Fill the gaps of each column that are narrow enough for their depth."""
    for u in range(kept.shape[1]):
        last = -1
        for row in range(kept.shape[0]):
            if kept[row, u] == 0:
                continue
            if last >= 0 and 0 < row - last - 1 <= gap[last]:
                kept[last + 1 : row, u] = 1
            last = row


@njit(cache=True, nogil=True)
def _extents(counts: Ints, labels: Ints, boxes: Ints, number: int, trimmed: float) -> Floats:
    """Return left, right, near, far, mean row + 0.5 and mass (N, 6) of the components."""
    found = np.zeros((number - 1, 6))
    for label in range(1, number):
        left, top, width, height = boxes[label, :4]
        columns, rows = np.zeros(width), np.zeros(height)
        for row in range(height):
            for u in range(width):
                if labels[top + row, left + u] == label:
                    columns[u] += counts[top + row, left + u]
                    rows[row] += counts[top + row, left + u]
        mass = columns.sum()
        first, last = _trim(columns, trimmed * mass)
        near, far = _trim(rows, trimmed * mass)
        mean = (rows * np.arange(height)).sum() / max(mass, 1.0) + top + 0.5
        found[label - 1, :2] = left + first, left + last
        found[label - 1, 2:4] = top + near, top + far
        found[label - 1, 4:] = mean, mass
    return found


@njit(cache=True, nogil=True)
def _trim(mass: Floats, least: float) -> tuple[int, int]:
    """Return the first and last position after trimming a share at either end."""
    first, last, seen = 0, len(mass) - 1, mass[0]
    while seen <= least and first < last:
        first += 1
        seen += mass[first]
    seen = mass[last]
    while seen <= least and last > first:
        last -= 1
        seen += mass[last]
    return first, last
