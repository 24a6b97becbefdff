"""Single rays against skins, next to the edges of an image (numba kernels)."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.shapes.bounds import NEAR_M
from peopleboy.sim.shapes.skins import SkinTable

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]

_SLACK_PX2 = 1e-9  # twice the area by which a ray may miss a triangle, so that no gap opens between two


class SkinBins(NamedTuple):
    """The triangles that may be met by rays within some pixels of an image.

    Attributes:
        first: (H W + 1,) where each pixel's triangles begin in `among`.
        among: (N,) numbers of triangles.
        image: (V, 3) column, row [px] and nearness [1/m] of the vertices.
        corners: (T, 3) vertices of the triangles.
        part: (T,) parts of the triangles.
    """

    first: Numbers
    among: Numbers
    image: Array
    corners: Numbers
    part: NDArray[np.int32]


NO_BINS = SkinBins(
    np.zeros(1, np.int64),
    np.zeros(0, np.int64),
    np.zeros((0, 3)),
    np.zeros((0, 3), np.int64),
    np.zeros(0, np.int32),
)


@njit(cache=True, nogil=True)
def edges_of_skins(part: NDArray[np.int32], surface: NDArray[np.int32], first: int) -> Mask:
    """Return the pixels (H, W) next to those of another part, if either is a skin's.

    Args:
        part: (H, W) parts seen.
        surface: (H, W) surfaces seen.
        first: number of the first surface that is a skin's; so are all after it.
    """
    height, width = part.shape
    found, none = np.zeros((height, width), np.bool_), np.int32(-1)
    for v in range(height):
        for u in range(width):
            is_skin = part[v, u] != none and surface[v, u] >= first
            for y, x in ((v, u + 1), (v + 1, u)):
                if y < height and x < width and part[y, x] != part[v, u]:
                    is_edge = is_skin or (part[y, x] != none and surface[y, x] >= first)
                    found[v, u] |= is_edge
                    found[y, x] |= is_edge
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def sort_into_bins(skins: SkinTable, points: Array, lens: Lens, is_wanted: Mask) -> SkinBins:
    """Find the triangles whose front may be met within wanted pixels (H, W).

    Args:
        skins: the skins.
        points: (V, 3) [m] their vertices in the optical frame.
        lens: the camera.
        is_wanted: (H, W) pixels in which rays will be cast.
    """
    image = np.empty_like(points)
    for v in range(len(points)):
        nearness = 1.0 / points[v, 2]
        image[v, 0] = lens.centre_u + lens.focal * points[v, 0] * nearness
        image[v, 1] = lens.centre_v + lens.focal * points[v, 1] * nearness
        image[v, 2] = nearness
    first, count = np.zeros(is_wanted.size + 1, np.int64), 0
    windows = np.empty((len(skins.triangles) + 1, 5), np.int64)
    for t in range(len(skins.triangles)):
        if _pixels_of(image, skins.triangles[t], lens, windows[count]):
            windows[count, 4] = t
            found = _enter(windows[count], is_wanted, first[1:], first[:0])
            count += found > 0
    first = np.cumsum(first)
    among, free = np.empty(first[-1], np.int64), first[:-1].copy()
    for i in range(count):
        _enter(windows[i], is_wanted, free, among)
    return SkinBins(first, among, image, skins.triangles, skins.part)


@njit(cache=True, nogil=True, error_model="numpy")
def _enter(window: Numbers, is_wanted: Mask, places: Numbers, among: Numbers) -> int:
    """Count a triangle at the wanted pixels of its window (5,), or enter it there unless `among` is empty.

    Returns the number of these pixels; `places` (H W,) goes up by one at each.
    """
    found, width = 0, is_wanted.shape[1]
    for y in range(window[2], window[3] + 1):
        for x in range(window[0], window[1] + 1):
            if is_wanted[y, x]:
                place = y * width + x
                if len(among):
                    among[places[place]] = window[4]
                places[place] += 1
                found += 1
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def _pixels_of(image: Array, corners: Numbers, lens: Lens, window: Numbers) -> bool:
    """Write first and last column and row (4,) of a triangle's pixels; return whether its front has any."""
    a, b, c = image[corners[0]], image[corners[1]], image[corners[2]]
    area = (c[0] - a[0]) * (b[1] - a[1]) - (b[0] - a[0]) * (c[1] - a[1])
    nearest, farthest = max(a[2], b[2], c[2]), min(a[2], b[2], c[2])
    if not area > 0.0 or farthest <= 0.0 or nearest * NEAR_M > 1.0:
        return False
    left, right = max(min(a[0], b[0], c[0]), 0.0), min(max(a[0], b[0], c[0]), lens.width - 1.0)
    top, bottom = max(min(a[1], b[1], c[1]), 0.0), min(max(a[1], b[1], c[1]), lens.height - 1.0)
    if left > lens.width - 0.5 or right < -0.5 or top > lens.height - 0.5 or bottom < -0.5:
        return False
    window[0], window[1] = math.floor(min(left, lens.width - 1.0) + 0.5), math.floor(max(right, 0.0) + 0.5)
    window[2], window[3] = math.floor(min(top, lens.height - 1.0) + 0.5), math.floor(max(bottom, 0.0) + 0.5)
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def hit_skin(bins: SkinBins, pixel: int, part: int, u: float, v: float) -> float:
    """Return the nearness [1/m] at which a ray within a pixel meets a part of a skin, 0 for a miss.

    Args:
        bins: the triangles by pixel.
        pixel: number of the pixel, row by row.
        part: number of the part.
        u: column of the ray [px].
        v: row of the ray [px].
    """
    nearest = 0.0
    for n in range(bins.first[pixel], bins.first[pixel + 1]):
        t = bins.among[n]
        if bins.part[t] != part:
            continue
        a, b, c = (
            bins.image[bins.corners[t, 0]],
            bins.image[bins.corners[t, 1]],
            bins.image[bins.corners[t, 2]],
        )
        ax, ay, bx, by, cx, cy = a[0] - u, a[1] - v, b[0] - u, b[1] - v, c[0] - u, c[1] - v
        of_a, of_b, of_c = cx * by - bx * cy, ax * cy - cx * ay, bx * ay - ax * by
        if min(of_a, of_b, of_c) >= -_SLACK_PX2:
            nearest = max(nearest, (of_a * a[2] + of_b * b[2] + of_c * c[2]) / (of_a + of_b + of_c))
    return nearest
