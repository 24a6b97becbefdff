"""The kernels that read an image under contours, point by point and section by section."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.contour.contour import CHUNK, GREYS, SECTIONS, SHOULDER_LEFT
from peopleboy.tracker.thermal.particles import D, Floats, H, W, X, Y

ELSEWHERE, ABOVE = np.int32(-1), np.int32(-2)  # instead of the pixels of points outside the image
UNKNOWN: Final = 1e-4  # share of a section's weight that is none
_MARGIN: Final = 1.0  # [px] by which a contour must be inside of the image to be so whatever rounding does


@njit(cache=True, fastmath={"contract"}, nogil=True)
def measure_sections(
    image: NDArray[np.uint8],
    state: Floats,
    chunks: Floats,
    reach: Floats,
    first: NDArray[np.int64],
    response: Floats,
    covered_grey: int,
    missing: Floats,
) -> tuple[Floats, Floats]:
    """Measure the mean response (N, 8) of all sections, and what share (N, 8) of their weight they keep.

    Samples that were drawn from the same one differ in d alone, which moves nothing but the head; so what
    is below it is measured once.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        chunks: (C, 7, 16) of `Probes`.
        reach: (2, 7) of `Probes`.
        first: (9,) of `Probes`.
        response: (8, 511) what a difference of grey counts.
        covered_grey: grey of people in front; one that no pixel has in an image without such marks.
        missing: (4,) what a pair counts with a point outside the image, and its weight above it; the same
            with a point on people in front.
    """
    height, width = image.shape
    grey, counts, at = image.reshape(-1), response.reshape(-1), np.empty(chunks.size // 7, dtype=np.int32)
    result = np.empty((len(state), SECTIONS), dtype=np.float32)
    known = np.empty((len(state), SECTIONS), dtype=np.float32)
    elsewhere, unseen, covered = missing[0], missing[1] * missing[0], missing[3] * missing[2]
    unseen_lacks, covered_lacks = np.float32(1) - missing[1], np.float32(1) - missing[3]
    head_chunks = 2 * _chunks(first[SHOULDER_LEFT])
    for i in range(len(state)):
        twin = _twin(state, i)
        sections, used = (SECTIONS, len(chunks)) if twin < 0 else (SHOULDER_LEFT, head_chunks)
        for j in range(sections, SECTIONS):
            result[i, j], known[i, j] = result[twin, j], known[twin, j]
        if _is_whole(state[i], reach, width, height):
            _locate_inside(at, state[i], chunks[:used], width)
        else:
            _locate(at, state[i], chunks[:used], width, height)
        for j in range(np.uint64(sections)):
            inner, outer = _starts(first, j)
            count, even = np.float32(first[j + 1] - first[j]), np.int64(j * (2 * GREYS - 1) + GREYS - 1)
            total, left = np.float32(0), np.float32(1)
            # Unsigned, as numba would ask of every other number whether it counts from the end.
            for p in range(np.uint64(first[j]), np.uint64(first[j + 1])):
                one, other = at[inner + p], at[outer + p]
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
def _twin(state: Floats, i: int) -> int:
    """Find a sample among the two before the i-th whose body is the same; negative if there is none.

    Two, since every few samples one is tried at another size.
    """
    for before in (i - 1, i - 2):
        if before >= 0 and (
            state[i, X] == state[before, X]
            and state[i, Y] == state[before, Y]
            and state[i, W] == state[before, W]
            and state[i, H] == state[before, H]
        ):
            return before
    return -1


@njit(cache=True, nogil=True)
def _chunks(points: int) -> int:
    """Tell how many chunks so many points take."""
    return (points + CHUNK - 1) // CHUNK


@njit(cache=True, nogil=True)
def _starts(first: NDArray[np.int64], section: int) -> tuple[np.uint64, np.uint64]:
    """Tell where in all chunks the inner and the outer points of pair 0 would be, for a section's pairs."""
    head = first[SHOULDER_LEFT]
    inner, each = np.int64(0), CHUNK * _chunks(head)
    if section >= SHOULDER_LEFT:
        inner, each = 2 * each - head, CHUNK * _chunks(first[SECTIONS] - head)
    return np.uint64(inner), np.uint64(inner + each)


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
def share_in_view(
    image: NDArray[np.uint8], sample: Floats, chunks: Floats, first: NDArray[np.int64], covered_grey: int
) -> NDArray[np.float64]:
    """Measure which share (8,) of every section's pairs is in an image (H, W) and not covered."""
    grey, at = image.reshape(-1), locate_points(sample, chunks, image.shape[1], image.shape[0])
    shares = np.ones(SECTIONS)
    for j in range(SECTIONS):
        inner, outer = _starts(first, j)
        seen = 0
        for p in range(np.uint64(first[j]), np.uint64(first[j + 1])):
            one, other = at[inner + p], at[outer + p]
            seen += (one | other) >= 0 and grey[one] != covered_grey and grey[other] != covered_grey
        if first[j + 1] > first[j]:
            shares[j] = seen / (first[j + 1] - first[j])
    return shares


@njit(cache=True, nogil=True)
def locate_points(sample: Floats, chunks: Floats, width: int, height: int) -> NDArray[np.int32]:
    """Give the pixels (16 C,) under the points of a contour (9,), by chunks."""
    at = np.empty(chunks.size // 7, dtype=np.int32)
    _locate(at, sample, chunks, width, height)
    return at


@njit(cache=True, nogil=True)
def _is_whole(sample: Floats, reach: Floats, width: int, height: int) -> bool:
    """Tell whether all points of a contour (9,) are surely in the image."""
    x, y, d, w, h = sample[X], sample[Y], sample[D], sample[W], sample[H]
    low, high = reach[0], reach[1]
    return bool(
        w > 0
        and h > 0
        and x + min(low[0] * d, high[0] * d) + low[1] * w + low[2] * h + low[3] > _MARGIN
        and x + max(low[0] * d, high[0] * d) + high[1] * w + high[2] * h + high[3] < width - 1 - _MARGIN
        and y + low[4] * w + low[5] * h + low[6] > _MARGIN
        and y + high[4] * w + high[5] * h + high[6] < height - 1 - _MARGIN
    )


@njit(cache=True, fastmath={"contract"}, nogil=True)
def _locate_inside(at: NDArray[np.int32], sample: Floats, chunks: Floats, width: int) -> None:
    """Locate points as `_locate` does that are all in the image."""
    half, columns = np.float32(0.5), np.int32(width)
    x, y, d, w, h = sample[X] + half, sample[Y] + half, sample[D], sample[W], sample[H]
    for c in range(len(chunks)):
        mix, pixels = chunks[c], at[c * CHUNK : (c + 1) * CHUNK]
        for k in range(CHUNK):
            u = x + mix[0, k] * d + mix[1, k] * w + mix[2, k] * h + mix[3, k]
            v = y + mix[4, k] * w + mix[5, k] * h + mix[6, k]
            pixels[k] = np.int32(v) * columns + np.int32(u)


@njit(cache=True, fastmath={"contract"}, nogil=True)
def _locate(at: NDArray[np.int32], sample: Floats, chunks: Floats, width: int, height: int) -> None:
    """Write the pixels of `pixels_under`, by chunks; without branches, many at a time."""
    half, columns, right, bottom = np.float32(0.5), np.int32(width), np.float32(width), np.float32(height)
    x, y, d, w, h = sample[X] + half, sample[Y] + half, sample[D], sample[W], sample[H]
    for c in range(len(chunks)):
        mix, pixels = chunks[c], at[c * CHUNK : (c + 1) * CHUNK]
        for k in range(CHUNK):
            u = x + mix[0, k] * d + mix[1, k] * w + mix[2, k] * h + mix[3, k]
            v = y + mix[4, k] * w + mix[5, k] * h + mix[6, k]
            is_inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom)
            outside = ABOVE if (v < 0) & (u >= 0) & (u < right) else ELSEWHERE
            pixels[k] = np.int32(v) * columns + np.int32(u) if is_inside else outside
