"""Kernels that sample an image along contours, point by point and section by section."""

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import exponential
from peopleboy.tracker.reproductions.contour.measurement.contour import FEET, GREYS, SECTIONS
from peopleboy.tracker.reproductions.contour.particles import D, Floats, H, W, X, Y

ELSEWHERE, ABOVE = np.int32(-1), np.int32(-2)  # index of points outside the image
UNKNOWN: Final = 1e-4  # share of a section's weight that counts as zero
LANES: Final = 64  # samples measured in parallel, a few vectors of any processor
SOME: Final = np.uint64(24)  # greatest number of these that are measured separately


@njit(cache=True, nogil=True)
def measure_sections(
    image: NDArray[np.uint8],
    state: Floats,
    mix: Floats,
    same: NDArray[np.int64],
    first: NDArray[np.int64],
    response: Floats,
    covered_grey: int,
    missing: tuple[float, float, float, float],
    feet_gain: float,
) -> tuple[Floats, Floats]:
    """Measure the mean response (N, 8) of all sections, and the share of weight that they keep.

    The latter is (N, 8), or (0, 8) if points always keep their weight.

    Args:
        image: (H, W) grey.
        state: (N, 9) samples.
        mix: (7, 2 P) of `Probes`.
        same: (2 P,) of `Probes`.
        first: (9,) of `Probes`.
        response: (8, 511) response to a grey difference.
        covered_grey: grey of people in front; unused in an image without such marks.
        missing: response of a pair with a point outside the image, and its weight above it; the same with a
            point on people in front.
        feet_gain: factor on the response of the feet, limited to 1; 0 leaves it unchanged.
    """
    result = np.empty((len(state), SECTIONS), dtype=np.float32)
    # If every point keeps its weight, so does every section.
    known = np.ones((len(state) if min(missing[1], missing[3]) < 1 else 0, SECTIONS), dtype=np.float32)
    lanes, at = np.empty((6, LANES), dtype=np.float32), np.empty((mix.shape[1], LANES), dtype=np.int32)
    total, left = np.empty(LANES, dtype=np.float32), np.empty(LANES, dtype=np.float32)
    lowest, lane = np.empty(LANES, dtype=np.int32), np.empty(LANES, dtype=np.uint64)
    grey, counts = image.reshape(-1), response.reshape(-1)
    for start in range(0, len(state), LANES):
        _load(lanes, state, start)
        _locate(at, lowest, lanes, mix, same, image.shape)
        count = min(LANES, len(state) - start)
        special = lane[: _find_special(lane, lowest[:count], covered_grey >= 0)]
        for j in range(SECTIONS):
            section = j, first[j], first[j + 1]
            if len(special) < count:
                _add_up_in_view(total, at, same, grey, counts, section)
            if len(special) > 0:
                _add_up(total, left, special, at, same, grey, counts, section, covered_grey, missing)
                _put(known, left, start, j)
            if j == FEET and feet_gain > 0:
                for k in range(LANES):
                    total[k] = min(np.float32(1), np.float32(feet_gain) * total[k])
            _put(result, total, start, j)
    return result, known


@njit(cache=True, nogil=True)
def _put(table: Floats, values: Floats, start: int, j: int) -> None:
    """Write values (K,) into a column of a table (N, 8), in the rows from `start` on, unless it is empty."""
    if len(table) > 0:
        for k in range(np.uint64(min(LANES, len(table) - start))):
            table[np.uint64(start) + k, np.uint64(j)] = values[k]


@njit(cache=True, nogil=True)
def _load(lanes: Floats, state: Floats, start: int) -> None:
    """Write x, y, d, w, h and x + d of samples in columns, from row `start` on.

    The last one is repeated until all lanes are full. Coordinates are shifted by half a pixel.
    """
    half = np.float32(0.5)
    for k in range(LANES):
        i = np.uint64(min(start + k, len(state) - 1))
        lanes[0, k], lanes[1, k] = state[i, X] + half, state[i, Y] + half
        lanes[2, k], lanes[3, k], lanes[4, k] = state[i, D], state[i, W], state[i, H]
        lanes[5, k] = lanes[0, k] + lanes[2, k]


@njit(cache=True, nogil=True)
def _locate(
    at: NDArray[np.int32],
    lowest: NDArray[np.int32],
    lanes: Floats,
    mix: Floats,
    same: NDArray[np.int64],
    shape: tuple[int, int],
) -> None:
    """Write the pixels (2 P, K) of the pairs of points of the samples, vectorised and without branches.

    Rows of points that coincide with an earlier one are skipped. The minimum (K,) of a sample's pixels is
    negative if not all of them are in the image.
    """
    columns, right, bottom = np.int32(shape[1]), np.float32(shape[1]), np.float32(shape[0])
    zero = np.float32(0)
    lowest[:] = 0
    # Unsigned, as numba would otherwise check for negative indices.
    for q in range(np.uint64(len(at))):
        if same[q] != np.int64(q):
            continue
        du, wu, hu, u0 = mix[0, q], mix[1, q], mix[2, q], mix[3, q]
        wv, hv, v0 = mix[4, q], mix[5, q], mix[6, q]
        # For head and feet, or for the body: zero terms are omitted.
        if wu == zero and wv == zero and (du == zero or du == np.float32(1)):
            base = np.uint64(0) if du == zero else np.uint64(5)
            for k in range(np.uint64(LANES)):
                u = lanes[base, k] + hu * lanes[4, k] + u0
                v = lanes[1, k] + hv * lanes[4, k] + v0
                at[q, k] = _pixel(u, v, columns, right, bottom)
                lowest[k] = min(lowest[k], at[q, k])
        else:
            for k in range(np.uint64(LANES)):
                u = lanes[0, k] + du * lanes[2, k] + wu * lanes[3, k] + hu * lanes[4, k] + u0
                v = lanes[1, k] + wv * lanes[3, k] + hv * lanes[4, k] + v0
                at[q, k] = _pixel(u, v, columns, right, bottom)
                lowest[k] = min(lowest[k], at[q, k])


@njit(cache=True, nogil=True)
def _find_special(lane: NDArray[np.uint64], lowest: NDArray[np.int32], are_all: bool) -> np.int64:
    """List the samples (K,) with points outside the image or on people in front, and return their number.

    All of them if there are so many that a separate measurement does not pay.
    """
    count = np.uint64(0)
    for k in range(np.uint64(len(lowest))):
        lane[count] = k
        count += np.uint64(lowest[k] < 0)
    if are_all or count > SOME:
        for k in range(np.uint64(len(lowest))):
            lane[k] = k
        return np.int64(len(lowest))
    return np.int64(count)


@njit(cache=True, nogil=True)
def _pixel(
    u: np.float32, v: np.float32, columns: np.int32, right: np.float32, bottom: np.float32
) -> np.int32:
    """Return the index of the pixel of a point."""
    is_inside = (u >= 0) & (v >= 0) & (u < right) & (v < bottom)
    outside = ABOVE if (v < 0) & (u >= 0) & (u < right) else ELSEWHERE
    # Cast to 32 bits at once, or everything would be computed with 64.
    number = np.int32(np.int32(v) * columns + np.int32(u))
    return number if is_inside else outside


@njit(cache=True, nogil=True, error_model="numpy")
def _add_up_in_view(
    total: Floats,
    at: NDArray[np.int32],
    same: NDArray[np.int64],
    grey: NDArray[np.uint8],
    counts: Floats,
    section: tuple[int, int, int],
) -> None:
    """Average the responses (K,) of a section's pairs for samples that are entirely in the image.

    The result is meaningless for the others.
    """
    j, begin, end = section
    even, pairs, count = j * (2 * GREYS - 1) + GREYS - 1, np.uint64(len(at) // 2), np.float32(end - begin)
    nowhere = np.int32(0)
    total[:] = 0
    for p in range(np.uint64(begin), np.uint64(end)):
        one, other = np.uint64(same[p]), np.uint64(same[p + pairs])
        for k in range(np.uint64(LANES)):
            mine, its = np.uint64(max(at[one, k], nowhere)), np.uint64(max(at[other, k], nowhere))
            inside, outside = np.int64(grey[mine]), np.int64(grey[its])
            total[k] += counts[np.uint64(even + inside - outside)]
    if count > 0:
        for k in range(LANES):
            total[k] /= count


# Without NumPy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def _add_up(
    total: Floats,
    left: Floats,
    special: NDArray[np.uint64],
    at: NDArray[np.int32],
    same: NDArray[np.int64],
    grey: NDArray[np.uint8],
    counts: Floats,
    section: tuple[int, int, int],
    covered_grey: int,
    missing: tuple[float, float, float, float],
) -> None:
    """Average the responses (K,) of a section's pairs for some samples, and the share (K,) of weight kept.

    The section is given by its number, its first pair, and the next section's. Others keep all their weight.
    """
    j, begin, end = section
    even, pairs, count = j * (2 * GREYS - 1) + GREYS - 1, np.uint64(len(at) // 2), np.float32(end - begin)
    elsewhere, unseen_share = np.float32(missing[0]), np.float32(missing[1])
    covered_share = np.float32(missing[3])
    unseen, covered = unseen_share * elsewhere, covered_share * np.float32(missing[2])
    unseen_lacks, covered_lacks = np.float32(1) - unseen_share, np.float32(1) - covered_share
    left[:] = 1
    for k in special:
        counted, kept = np.float32(0), np.float32(1)
        for p in range(np.uint64(begin), np.uint64(end)):
            one, other = at[np.uint64(same[p]), k], at[np.uint64(same[p + pairs]), k]
            if (one | other) < 0:
                if one == ELSEWHERE or other == ELSEWHERE:
                    counted += elsewhere
                else:
                    counted += unseen
                    kept -= unseen_lacks / count
                continue
            inside, outside = np.int64(grey[np.uint64(one)]), np.int64(grey[np.uint64(other)])
            if inside == covered_grey or outside == covered_grey:
                counted += covered
                kept -= covered_lacks / count
            else:
                counted += counts[np.uint64(even + inside - outside)]
        has_some = count > 0 and kept > UNKNOWN
        total[k], left[k] = counted / (count * kept) if has_some else counted, kept


@njit(cache=True, nogil=True)
def fill_unknown(differences: Floats, known: Floats, weights: Floats) -> None:
    """Fill the missing weight of sections (N, 8), in place, with the average of the other sections."""
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
def weighted_sums(differences: Floats, weights: NDArray[np.float64], weakest_share: float) -> Floats:
    """Return the weighted sums (N,) of sections (N, 8), moved by a share to the weakest except the feet."""
    fit, part = np.empty(len(differences), dtype=np.float32), np.float32(weakest_share)
    share = weights.astype(np.float32)
    for i in range(np.uint64(len(fit))):
        total, weakest = np.float32(0), differences[i, 0]
        for j in range(np.uint64(SECTIONS)):
            total += share[j] * differences[i, j]
        for j in range(np.uint64(FEET)):
            weakest = min(weakest, differences[i, j])
        fit[i] = total + part * (weakest - total)
    return fit


@njit(cache=True, nogil=True, error_model="numpy")
def logistic(fit: Floats, slope: float, threshold: float, most: float) -> Floats:
    """Return the probability (N,) of fitnesses (N,), with log-odds clipped to +-most (equation 4.4)."""
    steep, middle, end, one = np.float32(2 * slope), np.float32(threshold), np.float32(most), np.float32(1)
    chance = np.empty_like(fit)
    for i in range(len(fit)):
        chance[i] = one / (one + exponential(-min(max(steep * (fit[i] - middle), -end), end)))
    return chance


@njit(cache=True, nogil=True)
def share_in_view(
    image: NDArray[np.uint8], sample: Floats, mix: Floats, first: NDArray[np.int64], covered_grey: int
) -> NDArray[np.float64]:
    """Return the share (8,) of every section's pairs inside an image (H, W) and not covered."""
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


@njit(cache=True, nogil=True)
def locate_points(at: NDArray[np.int32], sample: Floats, mix: Floats, width: int, height: int) -> None:
    """Write the pixels of `pixels_under` a contour (9,) into (2 P,)."""
    lanes, pixels = np.empty((6, LANES), dtype=np.float32), np.empty((len(at), LANES), dtype=np.int32)
    _load(lanes, sample.reshape(1, -1), 0)
    lowest = np.empty(LANES, dtype=np.int32)
    _locate(pixels, lowest, lanes, mix, np.arange(len(at)), (height, width))
    at[:] = pixels[:, 0]
