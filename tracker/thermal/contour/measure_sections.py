"""The kernels that read an image under contours, point by point and section by section."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.contour.contour import GREYS, SECTIONS
from peopleboy.tracker.thermal.particles import D, Floats, H, W, X, Y

ELSEWHERE, ABOVE = np.int32(-1), np.int32(-2)  # instead of the pixels of points outside the image
UNKNOWN: Final = 1e-4  # share of a section's weight that is none

_Mix = tuple[Floats, Floats, Floats, Floats, Floats, Floats, Floats]


@njit(cache=True, fastmath={"contract"}, nogil=True)
def measure_sections(
    image: NDArray[np.uint8],
    state: Floats,
    mix: Floats,
    first: NDArray[np.int64],
    response: Floats,
    covered_grey: int,
    missing: Floats,
) -> tuple[Floats, Floats]:
    """Measure the mean response (N, 8) of all sections, and what share (N, 8) of their weight they keep.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        mix: (7, 2 P) of `Probes`.
        first: (9,) of `Probes`.
        response: (8, 511) what a difference of grey counts.
        covered_grey: grey of people in front; one that no pixel has in an image without such marks.
        missing: (4,) what a pair counts with a point outside the image, and its weight above it; the same
            with a point on people in front.
    """
    pairs = first[SECTIONS]
    grey, counts, at = image.reshape(-1), response.reshape(-1), np.empty(2 * pairs, dtype=np.int32)
    inner, outer = at[:pairs], at[pairs:]
    result = np.empty((len(state), SECTIONS), dtype=np.float32)
    known = np.empty((len(state), SECTIONS), dtype=np.float32)
    elsewhere, unseen, covered = missing[0], missing[1] * missing[0], missing[3] * missing[2]
    unseen_lacks, covered_lacks = np.float32(1) - missing[1], np.float32(1) - missing[3]
    rows = mix[0], mix[1], mix[2], mix[3], mix[4], mix[5], mix[6]
    for i in range(len(state)):
        _locate(at, state[i], rows, image.shape[1], image.shape[0])
        for j in range(SECTIONS):
            count, even = np.float32(first[j + 1] - first[j]), np.int64(j * (2 * GREYS - 1) + GREYS - 1)
            total, left = np.float32(0), np.float32(1)
            # Unsigned, as numba would ask of every other number whether it counts from the end.
            for p in range(np.uint64(first[j]), np.uint64(first[j + 1])):
                one, other = inner[p], outer[p]
                if (one | other) < 0:
                    if one == ELSEWHERE or other == ELSEWHERE:
                        total += elsewhere
                    else:
                        total += unseen
                        left -= unseen_lacks / count
                    continue
                inside, outside = np.int64(grey[np.uint64(one)]), np.int64(grey[np.uint64(other)])
                if inside == covered_grey or outside == covered_grey:
                    total += covered
                    left -= covered_lacks / count
                else:
                    total += counts[np.uint64(even + inside - outside)]
            if count > 0 and left > UNKNOWN:
                total /= count * left
            result[i, j], known[i, j] = total, left
    return result, known


@njit(cache=True, nogil=True)
def fill_unknown(differences: Floats, known: Floats, weights: Floats) -> None:
    """Let sections (N, 8) count, in place, as far as they are not known, what the others say on average."""
    for i in range(len(differences)):
        total, whole = np.float32(0), np.float32(0)
        for j in range(SECTIONS):
            total += weights[j] * known[i, j] * differences[i, j]
            whole += weights[j] * known[i, j]
        if whole <= UNKNOWN:
            continue
        for j in range(SECTIONS):
            differences[i, j] += (1 - known[i, j]) * (total / whole - differences[i, j])


@njit(cache=True, fastmath={"contract"}, nogil=True)
def locate_points(at: NDArray[np.int32], sample: Floats, mix: Floats, width: int, height: int) -> None:
    """Write the pixels of `pixels_under` a contour (9,) into (2 P,)."""
    _locate(at, sample, (mix[0], mix[1], mix[2], mix[3], mix[4], mix[5], mix[6]), width, height)


@njit(cache=True, fastmath={"contract"}, nogil=True)
def _locate(at: NDArray[np.int32], sample: Floats, mix: _Mix, width: int, height: int) -> None:
    """Locate points as `locate_points` does, without branches, many at a time."""
    half, columns, right, bottom = np.float32(0.5), np.int32(width), np.float32(width), np.float32(height)
    x, y, d, w, h = sample[X] + half, sample[Y] + half, sample[D], sample[W], sample[H]
    du, wu, hu, u0, wv, hv, v0 = mix
    for q in range(len(at)):
        u = x + du[q] * d + wu[q] * w + hu[q] * h + u0[q]
        v = y + wv[q] * w + hv[q] * h + v0[q]
        is_inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom)
        outside = ABOVE if (v < 0) & (u >= 0) & (u < right) else ELSEWHERE
        at[q] = np.int32(v) * columns + np.int32(u) if is_inside else outside
