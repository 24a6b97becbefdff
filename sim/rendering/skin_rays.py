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
Pixels = NDArray[np.int32]

_SLACK_PX2 = 1e-9  # twice the area by which a ray may miss a triangle, so that no gap opens between two


class SkinBins(NamedTuple):
    """The triangles that may be met by rays within some pixels of an image.

    Attributes:
        bin: (H, W) number of each pixel's bin, -1 where no rays are cast.
        first: (N + 1,) where each bin's triangles begin in `among`.
        among: numbers of triangles.
        image: (V, 3) column, row [px] and nearness [1/m] of the vertices.
        corners: (T, 3) vertices of the triangles.
        part: (T,) parts of the triangles.
    """

    bin: Pixels
    first: Pixels
    among: Pixels
    image: Array
    corners: Numbers
    part: Pixels


NO_BINS = SkinBins(
    np.full((1, 1), -1, np.int32),
    np.zeros(1, np.int32),
    np.zeros(0, np.int32),
    np.zeros((0, 3)),
    np.zeros((0, 3), np.int64),
    np.zeros(0, np.int32),
)


@njit(cache=True, nogil=True)
def edges_of_skins(part: Pixels, surface: Pixels, first: int) -> tuple[Pixels, int]:
    """Number the pixels next to those of another part, if either is a skin's.

    Args:
        part: (H, W) parts seen.
        surface: (H, W) surfaces seen.
        first: number of the first surface that is a skin's; so are all after it.

    Returns:
        (H, W) numbers from 0, -1 for all other pixels; and how many pixels there are.
    """
    height, width = part.shape
    found = np.full((height, width), np.int32(-1))
    for v in range(height):
        below = min(v + 1, height - 1)
        for u in range(width):
            right, p = min(u + 1, width - 1), part[v, u]
            if part[v, right] == p and part[below, u] == p:
                continue
            is_skin = p >= 0 and surface[v, u] >= first
            if part[v, right] != p and (is_skin or (part[v, right] >= 0 and surface[v, right] >= first)):
                found[v, u] = found[v, right] = 0
            if part[below, u] != p and (is_skin or (part[below, u] >= 0 and surface[below, u] >= first)):
                found[v, u] = found[below, u] = 0
    count = 0
    for v in range(height):
        for u in range(width):
            if found[v, u] == 0:
                found[v, u] = count
                count += 1
    return found, count


@njit(cache=True, nogil=True, error_model="numpy")
def sort_into_bins(  # noqa: C901 (in one function, as calls with arrays take long)
    skins: SkinTable, points: Array, lens: Lens, bins: Pixels, count: int
) -> SkinBins:
    """Find the triangles whose front may be met within each of some pixels.

    Args:
        skins: the skins.
        points: (V, 3) [m] their vertices in the optical frame.
        lens: the camera.
        bins: (H, W) numbers of the pixels, as returned by `edges_of_skins`.
        count: how many pixels there are.
    """
    image = np.empty_like(points)
    for v in range(len(points)):
        nearness = 1.0 / points[v, 2]
        image[v, 0] = lens.centre_u + lens.focal * points[v, 0] * nearness
        image[v, 1] = lens.centre_v + lens.focal * points[v, 1] * nearness
        image[v, 2] = nearness
    corners, first = skins.triangles, np.zeros(count + 1, np.int32)
    windows, found = np.empty((len(corners), 5), np.int32), 0
    for t in range(len(corners)):
        a, b, c = corners[t, 0], corners[t, 1], corners[t, 2]
        ax, ay, bx, by, cx, cy = image[a, 0], image[a, 1], image[b, 0], image[b, 1], image[c, 0], image[c, 1]
        left, right = _pixel(min(ax, bx, cx), lens.width), _pixel(max(ax, bx, cx), lens.width)
        top, bottom = _pixel(min(ay, by, cy), lens.height), _pixel(max(ay, by, cy), lens.height)
        p, q, r = image[a, 2], image[b, 2], image[c, 2]
        is_ahead = (min(p, q, r) > 0.0) & (max(p, q, r) * NEAR_M <= 1.0)
        if not is_ahead or (cx - ax) * (by - ay) - (bx - ax) * (cy - ay) <= 0.0:
            continue
        entered = 0
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                place = bins[y, x]
                if place >= 0:
                    first[place + 1] += np.int32(1)
                    entered += 1
        if entered > 0:
            windows[found, 0], windows[found, 1], windows[found, 2] = t, left, right
            windows[found, 3], windows[found, 4] = top, bottom
            found += 1
    for i in range(count):
        first[i + 1] += first[i]
    among, free = np.empty(first[count], np.int32), first.copy()
    for i in range(found):
        for y in range(windows[i, 3], windows[i, 4] + 1):
            for x in range(windows[i, 1], windows[i, 2] + 1):
                place = bins[y, x]
                if place >= 0:
                    among[free[place]] = windows[i, 0]
                    free[place] += np.int32(1)
    return SkinBins(bins, first, among, image, corners, skins.part)


@njit(cache=True, nogil=True)
def _pixel(at: float, size: int) -> int:
    """Return the number of the pixel around a position [px], that at the border for positions outside."""
    return math.floor(min(max(at, 0.0), size - 1.0) + 0.5)


@njit(cache=True, nogil=True, error_model="numpy")
def hit_skin(bins: SkinBins, x: int, y: int, part: int, u: float, v: float) -> float:
    """Return the nearness [1/m] at which a ray within a pixel meets a part of a skin, 0 for a miss.

    Args:
        bins: the triangles by pixel.
        x: column of the pixel, which has a bin.
        y: row of the pixel.
        part: number of the part.
        u: column of the ray [px].
        v: row of the ray [px].
    """
    nearest, own, image = 0.0, bins.bin[y, x], bins.image
    for i in range(bins.first[own], bins.first[own + 1]):
        t = bins.among[i]
        if bins.part[t] != part:
            continue
        a, b, c = bins.corners[t, 0], bins.corners[t, 1], bins.corners[t, 2]
        ax, ay, bx, by = image[a, 0] - u, image[a, 1] - v, image[b, 0] - u, image[b, 1] - v
        cx, cy = image[c, 0] - u, image[c, 1] - v
        of_a, of_b, of_c = cx * by - bx * cy, ax * cy - cx * ay, bx * ay - ax * by
        if min(of_a, of_b, of_c) >= -_SLACK_PX2:
            mixed = of_a * image[a, 2] + of_b * image[b, 2] + of_c * image[c, 2]
            nearest = max(nearest, mixed / (of_a + of_b + of_c))
    return nearest
