"""Pre-detections: all objects of human size in a depth image."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.depth.depth_view import Depth, DepthView, RgbdView
from peopleboy.tracker.sensors.depth.u_depth import (
    STEP_1_M,
    DepthPiece,
    Ints,
    UDepthConfig,
    depths_m,
    find_pieces,
    u_depth,
)
from peopleboy.tracker.sensors.depth.v_disparity import HeightLine, find_ceiling, find_floor, v_disparity
from peopleboy.tracker.sensors.depth.walls import DepthWall, bands_mm, find_walls, tall_disparity, without
from peopleboy.tracker.track import Box

# Classification by size.


@dataclass(frozen=True, slots=True)
class HumanSize:
    """Expected size of a human, with standard deviations (SA eq. 4.12 to 4.15).

    A camera only sees the front of a body, so the depth extent is smaller than the body's.

    Attributes:
        width_m, height_m, depth_m: [m] expected extents.
        width_sd_m, height_sd_m, depth_sd_m: [m] standard deviations.
        is_cut: whether the expected height is limited to the part inside the image.
        least: least probability of a detection.
    """

    width_m: float = 0.45
    height_m: float = 1.65
    depth_m: float = 0.35
    width_sd_m: float = 0.2
    height_sd_m: float = 0.35
    depth_sd_m: float = 0.25
    is_cut: bool = True
    least: float = 0.1

    def probability(self, width_m: float, height_m: float, depth_m: float, visible_m: float) -> float:
        """Return the probability of a size, 1 for the expected size.

        Args:
            width_m: measured width.
            height_m: measured height.
            depth_m: measured depth extent.
            visible_m: [m] part of the expected height that fits into the image.
        """
        expected = visible_m if self.is_cut else self.height_m
        squares = (
            ((width_m - self.width_m) / self.width_sd_m) ** 2
            + ((height_m - expected) / self.height_sd_m) ** 2
            + ((depth_m - self.depth_m) / self.depth_sd_m) ** 2
        )
        return math.exp(-0.5 * squares)


PRINTED_SIZE = HumanSize(
    width_m=0.7, height_m=1.65, depth_m=0.7, width_sd_m=0.35, height_sd_m=0.5, depth_sd_m=0.5, is_cut=False
)
"""SA 4.4.1; its standard deviations are not printed: narrower ones detect hardly anybody."""


_MARGIN_M: Final = 0.08  # margin above the floor and below the ceiling
_TALL_M: Final = 2.1  # greatest height of a human
_EMPTY_ROWS: Final = 4  # rows without readings that a body may have
_REACH_M: Final = 0.1  # SA 4.4.1: tolerance of the readings of an object's depth
_REACH_STEPS: Final = 0.7  # the same in steps of the sensor, where these are coarser


@dataclass(frozen=True, slots=True, kw_only=True)
class PreDetection:
    """An object of human size.

    Attributes:
        box: left, top, width, height [px].
        x_m, z_m: position of its middle, to the right and along the optical axis [m].
        width_m, height_m, depth_m: its extents [m].
        probability: of the size (SA eq. 4.15).
    """

    box: Box
    x_m: float
    z_m: float
    width_m: float
    height_m: float
    depth_m: float
    probability: float


def body_position(found: PreDetection, view: RgbdView) -> Floats:
    """Return the position (2,) of a body's middle, which is behind the visible surface."""
    deeper = 1.0 + view.body_m / math.hypot(found.x_m, found.z_m)
    at = np.array([found.x_m * deeper]), np.array([found.z_m * deeper])
    return np.asarray(view.geometry.on_floor(*at)[0])


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Structure of a depth image.

    Attributes:
        floor, ceiling: their lines; the ceiling is None if it is not visible.
        walls: their lines; empty if walls are not detected.
        counts: (D, W) readings by depth and column between floor, ceiling and walls.
        detections: objects of human size, the nearest first.
    """

    floor: HeightLine
    ceiling: HeightLine | None
    walls: tuple[DepthWall, ...]
    counts: Ints
    detections: tuple[PreDetection, ...]


@dataclass(frozen=True, slots=True)
class PreDetector:
    """Detects objects of human size (SA 4.4.1).

    Attributes:
        size: of a human.
        config: settings of the view from above.
    """

    size: HumanSize
    config: UDepthConfig

    def __call__(self, depth: Depth, view: DepthView) -> Layout:
        """Process a depth image (H, W) [mm]."""
        counts = v_disparity(depth, view)
        floor = find_floor(counts, view) or HeightLine(view.horizon_px / view.focal_px, view.height_m)
        ceiling = find_ceiling(counts, view)
        first, last = self._row_limits(floor, ceiling, view)
        walls: tuple[DepthWall, ...] = ()
        if self.config.has_walls:
            walls, depth = self._without_walls(depth, first, floor, view)
        above = u_depth(depth, first, last, self.config.row_m)
        pieces = find_pieces(above, self.config)
        rated = [self._rate(piece, depth, first, last, floor, view) for piece in pieces]
        likely = [one for one in rated if one is not None and one.probability > self.size.least]
        return Layout(floor, ceiling, walls, above, tuple(likely))

    def _row_limits(
        self, floor: HeightLine, ceiling: HeightLine | None, view: DepthView
    ) -> tuple[Floats, Floats]:
        depth_m = depths_m(self.config.row_m)
        last = floor.raised(_MARGIN_M).rows(depth_m, view)
        if ceiling is None:
            return np.full_like(last, -1.0), last
        return ceiling.raised(-_MARGIN_M).rows(depth_m, view), last

    def _without_walls(
        self, depth: Depth, first: Floats, floor: HeightLine, view: DepthView
    ) -> tuple[tuple[DepthWall, ...], Depth]:
        """Detect walls by readings above people's heads; return the image (H, W) without them, too."""
        heads = floor.raised(_TALL_M).rows(depths_m(self.config.row_m), view)
        tall = tall_disparity(depth, first, heads, self.config.row_m, view)
        walls = find_walls(tall, view)
        return walls, without(depth, *bands_mm(walls, tall, self.config.wall_m, view))

    def _rate(
        self, piece: DepthPiece, depth: Depth, first: Floats, last: Floats, floor: HeightLine, view: DepthView
    ) -> PreDetection | None:
        """Return the rows of a piece (SA 4.4.1, step 5), and the probability of its size."""
        scale = piece.depth_m / view.focal_px
        reach = max(_REACH_M, _REACH_STEPS * STEP_1_M * piece.depth_m**2)
        row = min(int(piece.depth_m / self.config.row_m), len(first) - 1)
        top, bottom = _rows_of(
            depth,
            (piece.left, piece.right),
            (
                1000.0 * min(piece.depth_m - reach, piece.near_m),
                1000.0 * max(piece.depth_m + reach, piece.far_m),
            ),
            (first[row], last[row]),
        )
        if bottom < top:
            return None
        width, height = piece.right - piece.left + 1, bottom - top + 1
        extents = (width * scale, height * scale, piece.far_m - piece.near_m)
        visible = self._visible_m(floor, piece.depth_m, depth.shape[0], view)
        return PreDetection(
            box=(float(piece.left), float(top), float(width), float(height)),
            x_m=((piece.left + piece.right) / 2.0 - view.centre_u) * scale,
            z_m=piece.depth_m,
            width_m=extents[0],
            height_m=extents[1],
            depth_m=extents[2],
            probability=self.size.probability(*extents, visible),
        )

    def _visible_m(self, floor: HeightLine, depth_m: float, rows: int, view: DepthView) -> float:
        """Return the part of a human's height that fits into the image at a depth [m]."""
        at = np.array([depth_m])
        foot = float(floor.rows(at, view)[0])
        head = float(floor.raised(self.size.height_m).rows(at, view)[0])
        return (min(foot, rows - 0.5) - max(head, -0.5)) * depth_m / view.focal_px


@njit(cache=True, nogil=True)
def _rows_of(
    depth: Depth, columns: tuple[int, int], span_mm: tuple[float, float], rows: tuple[float, float]
) -> tuple[int, int]:
    """Scan up from the lowest row for readings within a depth range; return the ends of the longest run.

    The source uses the first run, which may be a speck of the floor in front of the feet.
    """
    top, bottom = 0, -1
    first, last = 0, -1
    for v in range(min(int(rows[1]), depth.shape[0] - 1), max(int(rows[0]), 0) - 1, -1):
        if _has_reading(depth[v, columns[0] : columns[1] + 1], span_mm):
            if first - v > _EMPTY_ROWS or last < 0:
                last = v
            first = v
            if last - first > bottom - top:
                top, bottom = first, last
    return top, bottom


@njit(cache=True, nogil=True)
def _has_reading(row: NDArray[np.uint16], span_mm: tuple[float, float]) -> bool:
    return bool(((row >= span_mm[0]) & (row <= span_mm[1])).any())
