"""The kernels that read an image under contours, point by point and section by section."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.contour.contour import FEET, GREYS, SECTIONS, SHOULDER_LEFT
from peopleboy.tracker.thermal.particles import D, Floats, H, W, X, Y, twin_of

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
    missing: tuple[float, float, float, float],
    feet_gain: float,
) -> tuple[Floats, Floats]:
    """Measure the mean response (N, 8) of all sections, and what share (N, 8) of their weight they keep.

    What is below the head of samples that differ in d alone is measured once, as d moves nothing else.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        mix: (7, 2 P) of `Probes`.
        first: (9,) of `Probes`.
        response: (8, 511) what a difference of grey counts.
        covered_grey: grey of people in front; one that no pixel has in an image without such marks.
        missing: what a pair counts with a point outside the image, and its weight above it; the same with a
            point on people in front.
        feet_gain: factor on the response of the feet, which counts up to 1; 0 leaves it as it is.
    """
    pairs = first[SECTIONS]
    grey, counts, at = image.reshape(-1), response.reshape(-1), np.empty(2 * pairs, dtype=np.int32)
    inner, outer = at[:pairs], at[pairs:]
    result = np.empty((len(state), SECTIONS), dtype=np.float32)
    known = np.empty((len(state), SECTIONS), dtype=np.float32)
    elsewhere, unseen_share = np.float32(missing[0]), np.float32(missing[1])
    covered, covered_share = np.float32(missing[2]), np.float32(missing[3])
    unseen, covered = unseen_share * elsewhere, covered_share * covered
    unseen_lacks, covered_lacks = np.float32(1) - unseen_share, np.float32(1) - covered_share
    rows = mix[0], mix[1], mix[2], mix[3], mix[4], mix[5], mix[6]
    for i in range(len(state)):
        _locate(at, state[i], rows, image.shape[1], image.shape[0])
        twin = twin_of(state, i)
        sections = SECTIONS if twin < 0 else SHOULDER_LEFT
        for j in range(sections, SECTIONS):
            result[i, j], known[i, j] = result[twin, j], known[twin, j]
        for j in range(sections):
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
            if j == FEET and feet_gain > 0:
                total = min(np.float32(1), np.float32(feet_gain) * total)
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


@njit(cache=True, nogil=True)
def pull_to_weakest(fit: Floats, differences: Floats, share: float) -> None:
    """Move fitnesses (N,), in place, by a share towards the weakest of their sections (N, 8) but the feet."""
    part = np.float32(share)
    for i in range(len(fit)):
        weakest = differences[i, 0]
        for j in range(1, FEET):
            weakest = min(weakest, differences[i, j])
        fit[i] += part * (weakest - fit[i])


@njit(cache=True, nogil=True)
def negative_log_odds(fit: Floats, slope: float, threshold: float, most: float) -> Floats:
    """Give minus the logarithm of the odds (N,) of fitnesses (N,), within -most..most (equation 4.4)."""
    steep, middle, end = np.float32(2 * slope), np.float32(threshold), np.float32(most)
    result = np.empty_like(fit)
    for i in range(len(fit)):
        result[i] = -min(max(steep * (fit[i] - middle), -end), end)
    return result


@njit(cache=True, nogil=True)
def count_differences(image: NDArray[np.uint8], apart: int, stride: int) -> NDArray[np.int64]:
    """Count (256,) by how much pixels of an image (H, W) differ from those so far to the right, and below.

    Of the rows for the one, and of the columns for the other, every `stride`-th is looked at.
    """
    height, width = image.shape
    counts = np.zeros((2, GREYS), dtype=np.int64)
    for v in range(0, height, stride):
        for u in range(width - apart):
            counts[u & 1, abs(np.int64(image[v, u + apart]) - np.int64(image[v, u]))] += 1
    for v in range(height - apart):
        for u in range(0, width, stride):
            counts[v & 1, abs(np.int64(image[v + apart, u]) - np.int64(image[v, u]))] += 1
    both: NDArray[np.int64] = counts[0] + counts[1]
    return both


@njit(cache=True, fastmath={"contract"}, nogil=True)
def share_in_view(
    image: NDArray[np.uint8], sample: Floats, mix: Floats, first: NDArray[np.int64], covered_grey: int
) -> NDArray[np.float64]:
    """Measure which share (8,) of every section's pairs is in an image (H, W) and not covered."""
    pairs = first[SECTIONS]
    grey, at = image.reshape(-1), np.empty(2 * pairs, dtype=np.int32)
    locate_points(at, sample, mix, image.shape[1], image.shape[0])
    shares = np.ones(SECTIONS)
    for j in range(SECTIONS):
        seen = 0
        for p in range(first[j], first[j + 1]):
            one, other = at[p], at[pairs + p]
            seen += (one | other) >= 0 and grey[one] != covered_grey and grey[other] != covered_grey
        if first[j + 1] > first[j]:
            shares[j] = seen / (first[j + 1] - first[j])
    return shares


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
