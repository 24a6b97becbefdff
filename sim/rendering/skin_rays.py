"""Four rays in each pixel next to an edge, against skins (numba kernels)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.rendering.skin_canvas import SeenSkins, to_pixels
from peopleboy.sim.shapes.bounds import NEAR_M

Array = NDArray[np.float64]
Pixels = NDArray[np.int32]
Values = NDArray[np.float32]

_SLACK_PX2 = 1e-9  # twice the area by which a ray may miss a triangle, so that no gap opens between two


RAYS: Final = np.array([(-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375)])
"""[px] Positions of the rays, relative to the pixel's centre.

The first is nearest to the pixel above, the others to those on the right, on the left and below.
"""


class SkinHits(NamedTuple):
    """What rays in some pixels of an image hit first of all skins.

    Attributes:
        number: (H, W) number of each pixel, -1 where no rays are cast.
        nearness: (N, 4) [1/m] of what each ray hits, 0 for a miss.
        part: (N, 4) part that it hits, -1 for none.
    """

    number: Pixels
    nearness: Array
    part: Pixels


NO_HITS = SkinHits(np.full((1, 1), -1, np.int32), np.zeros((0, 4)), np.zeros((0, 4), np.int32))


@njit(cache=True, nogil=True)
def differ(one: Values, other: Values, contrast: np.float32) -> bool:
    """Return whether two values (C,) differ by more than the contrast."""
    for c in range(len(one)):  # noqa: SIM110 (kernels have no generators)
        if abs(one[c] - other[c]) > contrast:
            return True
    return False


@njit(cache=True, nogil=True)
def edges_of_skins(
    image: Values, contrast: np.float32, part: Pixels, surface: Pixels, first: int
) -> tuple[Pixels, int]:
    """Number the pixels next to those of another part with another value, if either is a skin's.

    Args:
        image: (H, W, C) the image.
        contrast: difference from which on values differ.
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
            for y, x in ((v, right), (below, u)):
                if (
                    part[y, x] != p
                    and (is_skin or (part[y, x] >= 0 and surface[y, x] >= first))
                    and differ(image[v, u], image[y, x], contrast)
                ):
                    found[v, u] = found[y, x] = 0
    count = 0
    for v in range(height):
        for u in range(width):
            if found[v, u] == 0:
                found[v, u] = count
                count += 1
    return found, count


@njit(cache=True, nogil=True, error_model="numpy")
def hit_skins(seen: SeenSkins, lens: Lens, number: Pixels, count: int) -> SkinHits:
    """Cast the rays of some pixels; only the fronts of triangles are hit.

    Args:
        seen: the skins.
        lens: the camera.
        number: (H, W) numbers of the pixels, as returned by `edges_of_skins`.
        count: how many pixels there are.
    """
    skins, image = seen.posed.table, np.empty_like(seen.image)
    to_pixels(seen.image, lens, image)
    hits = SkinHits(number, np.zeros((count, 4)), np.full((count, 4), np.int32(-1)))
    for t in range(len(skins.triangles)):
        a, b, c = skins.triangles[t, 0], skins.triangles[t, 1], skins.triangles[t, 2]
        ax, ay, bx, by, cx, cy = image[a, 0], image[a, 1], image[b, 0], image[b, 1], image[c, 0], image[c, 1]
        # Twice the area, positive from the front as rows go down.
        area = (cx - ax) * (by - ay) - (bx - ax) * (cy - ay)
        p, q, r = image[a, 2], image[b, 2], image[c, 2]
        is_ahead = (min(p, q, r) > 0.0) & (max(p, q, r) * NEAR_M <= 1.0)
        if not (is_ahead and area > 0.0):
            continue
        left, right = _pixel(min(ax, bx, cx), lens.width), _pixel(max(ax, bx, cx), lens.width)
        top, bottom = _pixel(min(ay, by, cy), lens.height), _pixel(max(ay, by, cy), lens.height)
        p, q, r = p / area, q / area, r / area
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                if number[y, x] < 0:
                    continue
                nearest, part = hits.nearness[number[y, x]], hits.part[number[y, x]]
                for k in range(4):
                    u, v = x + RAYS[k, 0], y + RAYS[k, 1]
                    of_a = (cx - u) * (by - v) - (bx - u) * (cy - v)
                    of_b = (ax - u) * (cy - v) - (cx - u) * (ay - v)
                    of_c = (bx - u) * (ay - v) - (ax - u) * (by - v)
                    here = of_a * p + of_b * q + of_c * r
                    if min(of_a, of_b, of_c) >= -_SLACK_PX2 and here > nearest[k]:
                        nearest[k], part[k] = here, skins.part[t]
    return hits


@njit(cache=True, nogil=True)
def _pixel(at: float, size: int) -> int:
    """Return the number of the pixel around a position [px], that at the border for positions outside."""
    return math.floor(min(max(at, 0.0), size - 1.0) + 0.5)
