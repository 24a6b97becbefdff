"""Segmentation network for panoramas: residual layers of dilated convolutions.

Units are stored with a border around the image, which is 0 above and below, and wraps over the seam, so that
a step to a neighbour has a constant offset in memory. Rows are added below the image to complete the last
block.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import exponential

Linear = NDArray[np.float32]
Places = NDArray[np.int64]

BLOCK: Final = 4
"""Side [px] of the squares that are one cell of the network."""
DILATIONS: Final = (1, 2, 4)
"""Distance in squares between the taps of each dilated layer."""
UNITS_TOGETHER, INPUTS_TOGETHER = 4, 6
"""Numbers of units and inputs per step of computation: each number read from memory is used as often as the
registers allow."""

_BORDER: Final = max(DILATIONS)
_HIGH: Final = 4
"""Rows of a block. They are one dilation apart, so that blocks interleave for dilations above 1."""
_BANDS: Final = _HIGH + 2
"""Linear combinations of rows from which a block is computed."""
_ROWS: Final = 8
"""Rows that the first and the last layer compute together, so that the sums stay in the cache."""

FEATURES: Final = 6
"""Inputs per pixel: red, green, blue, difference from the background, the background's age and its doubt."""
INPUTS: Final = BLOCK * BLOCK * FEATURES
OUTPUTS: Final = BLOCK * BLOCK
TOGETHER: Final = math.lcm(UNITS_TOGETHER, INPUTS_TOGETHER)
"""Divisor of the number of units."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MaskNetwork:
    """A trained network on R rows of squares, each with U units in every layer.

    Columns wrap round: an image rolled by whole squares gives the same output, rolled.

    Attributes:
        first: (INPUTS, U) weights of a square's own pixels.
        rows: (R, U) bias of the first layer, by row of squares.
        between: (L, 9, U, U) weights of the hidden layers, by neighbour from the upper left on.
        biases: (L, U) of the hidden layers.
        last: (U + INPUTS, OUTPUTS) weights of the last layer, which also sees the square's own pixels.
        bias: (OUTPUTS,) of the last layer.
    """

    first: Linear
    rows: Linear
    between: Linear
    biases: Linear
    last: Linear
    bias: Linear

    def predict(self, squares: Linear) -> Linear:
        """Return for each pixel (H, W) the probability that it is on a person.

        Args:
            squares: (INPUTS, H / BLOCK, W / BLOCK) features of each square, from `compare`.
        """
        units = first_layer(squares, self.first, self.rows)
        for weights, bias, dilation in zip(self.between, self.biases, DILATIONS, strict=True):
            units = dilated_layer(units, squares.shape[1], weights, bias, dilation)
        return last_layer(units, squares, self.last, self.bias)


@njit(cache=True, fastmath={"contract"})
def first_layer(squares: Linear, weights: Linear, biases: Linear) -> Linear:
    """First layer: from (INPUTS, R, C) to units (U, R + ..., C + ...) with their border."""
    _, rows, columns = squares.shape
    number = weights.shape[1]
    units = _bordered(number, rows, columns)
    sums = np.empty((number, _ROWS * columns), np.float32)
    for first in range(0, rows, _ROWS):
        count = min(_ROWS, rows - first)
        sums[:] = np.float32(0.0)
        _add_all(sums, count * columns, squares, first * columns, weights, 0)
        for unit in range(number):
            for k in range(count):
                line, bias = sums[unit, k * columns : (k + 1) * columns], biases[first + k, unit]
                inner = units[unit, _BORDER + first + k, _BORDER : _BORDER + columns]
                for u in range(columns):
                    inner[u] = max(line[u] + bias, np.float32(0.0))
    _close(units, rows)
    return units


@njit(cache=True, fastmath={"contract"})
def dilated_layer(units: Linear, rows: int, weights: Linear, biases: Linear, dilation: int) -> Linear:
    """A hidden layer: each unit is increased by the rectified convolution of its nine squares.

    Four rows take six multiplications per weight of a column instead of twelve.

    Source: A. Lavin, S. Gray, Fast algorithms for convolutional neural networks, CVPR 2016, F(4, 3).
    """
    number, high, wide = units.shape
    bands, taps = _mixed_rows(units, dilation), _mixed_weights(weights)
    sums = np.zeros((_BANDS, number, (high - 2 * _BORDER) // _HIGH * wide), np.float32)
    at = np.empty(INPUTS_TOGETHER, np.int64)
    line = bands.shape[2]
    for band in range(_BANDS):
        flat = bands[band].reshape(-1)
        for unit in range(0, number, UNITS_TOGETHER):
            for k in range(0, number, 2):
                for tap in range(3):
                    at[tap] = k * line + _BORDER + (tap - 1) * dilation
                    at[3 + tap] = at[tap] + line
                _add(sums[band], unit, sums.shape[2], flat, at, taps[band], 3 * k)
    grown = np.empty_like(units)
    _unmix(sums, units, biases, dilation, grown)
    _close(grown, rows)
    return grown


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def last_layer(units: Linear, squares: Linear, weights: Linear, biases: Linear) -> Linear:
    """Last layer: probabilities (H, W)."""
    _, rows, columns = squares.shape
    number, _, wide = units.shape
    outputs = len(biases)
    reported = np.empty((rows * BLOCK, columns * BLOCK), np.float32)
    of_units = np.empty((outputs, _ROWS * wide), np.float32)
    of_squares = np.empty((outputs, _ROWS * columns), np.float32)
    for first in range(0, rows, _ROWS):
        count = min(_ROWS, rows - first)
        of_units[:] = np.float32(0.0)
        of_squares[:] = np.float32(0.0)
        _add_all(of_units, count * wide, units, (_BORDER + first) * wide, weights, 0)
        _add_all(of_squares, count * columns, squares, first * columns, weights, number)
        for k in range(count):
            for output in range(outputs):
                line = reported[(first + k) * BLOCK + output // BLOCK]
                a = of_units[output, k * wide + _BORDER : (k + 1) * wide - _BORDER]
                b = of_squares[output, k * columns : (k + 1) * columns]
                _write_shares(line[output % BLOCK :], a, b, biases[output])
    return reported


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _write_shares(line: Linear, a: Linear, b: Linear, bias: np.float32) -> None:
    """Convert summed evidence to probabilities, in every BLOCK-th pixel."""
    for u in range(len(a)):
        line[u * BLOCK] = np.float32(1.0) / (np.float32(1.0) + exponential(-(a[u] + b[u] + bias)))


@njit(cache=True, fastmath={"contract"})
def _add_all(sums: Linear, count: int, inputs: Linear, start: int, weights: Linear, first: int) -> None:
    """Add all inputs (K, ...), weighted by rows from the first on, to all sums."""
    at = np.empty(INPUTS_TOGETHER, np.int64)
    flat, line = inputs.reshape(-1), inputs.shape[1] * inputs.shape[2]
    for unit in range(0, sums.shape[0], UNITS_TOGETHER):
        for k in range(0, inputs.shape[0], INPUTS_TOGETHER):
            for j in range(INPUTS_TOGETHER):
                at[j] = (k + j) * line + start
            _add(sums, unit, count, flat, at, weights, first + k)


@njit(cache=True, fastmath={"contract"})
def _add(
    sums: Linear, unit: int, count: int, inputs: Linear, at: Places, weights: Linear, first: int
) -> None:
    """Add six inputs of a given length at positions (6,) to the sums of four units.

    Their weights are the rows from the first on. Indices are unsigned, as only then the compiler skips the
    checks for negative ones and vectorises.
    """
    p, q, r, s, t, v = (
        weights[first], weights[first + 1], weights[first + 2],
        weights[first + 3], weights[first + 4], weights[first + 5],
    )  # fmt: skip
    p0, p1, p2, p3 = p[unit], p[unit + 1], p[unit + 2], p[unit + 3]
    q0, q1, q2, q3 = q[unit], q[unit + 1], q[unit + 2], q[unit + 3]
    r0, r1, r2, r3 = r[unit], r[unit + 1], r[unit + 2], r[unit + 3]
    s0, s1, s2, s3 = s[unit], s[unit + 1], s[unit + 2], s[unit + 3]
    t0, t1, t2, t3 = t[unit], t[unit + 1], t[unit + 2], t[unit + 3]
    v0, v1, v2, v3 = v[unit], v[unit + 1], v[unit + 2], v[unit + 3]
    a, b, c = np.uint64(at[0]), np.uint64(at[1]), np.uint64(at[2])
    d, e, f = np.uint64(at[3]), np.uint64(at[4]), np.uint64(at[5])
    sum0, sum1, sum2, sum3 = sums[unit], sums[unit + 1], sums[unit + 2], sums[unit + 3]
    for u in range(np.uint64(count)):
        x, y, z = inputs[a + u], inputs[b + u], inputs[c + u]
        k, o, m = inputs[d + u], inputs[e + u], inputs[f + u]
        sum0[u] = sum0[u] + p0 * x + q0 * y + r0 * z + s0 * k + t0 * o + v0 * m
        sum1[u] = sum1[u] + p1 * x + q1 * y + r1 * z + s1 * k + t1 * o + v1 * m
        sum2[u] = sum2[u] + p2 * x + q2 * y + r2 * z + s2 * k + t2 * o + v2 * m
        sum3[u] = sum3[u] + p3 * x + q3 * y + r3 * z + s3 * k + t3 * o + v3 * m


@njit(cache=True, fastmath={"contract"})
def _mixed_weights(weights: Linear) -> Linear:
    """Combine weights (9, U, U) of three rows into those of bands: (BANDS, 3 U, U), by unit and column."""
    number = weights.shape[1]
    mixed = np.empty((_BANDS, 3 * number, number), np.float32)
    for unit in range(number):
        for tap in range(3):
            a, b, c = weights[tap, unit], weights[3 + tap, unit], weights[6 + tap, unit]
            at = 3 * unit + tap
            for k in range(number):
                even, odd = a[k] + c[k], b[k]
                mixed[0, at, k] = a[k] / np.float32(4.0)
                mixed[1, at, k] = (even + odd) / np.float32(-6.0)
                mixed[2, at, k] = (even - odd) / np.float32(-6.0)
                even, odd = a[k] + np.float32(4.0) * c[k], np.float32(2.0) * b[k]
                mixed[3, at, k] = (even + odd) / np.float32(24.0)
                mixed[4, at, k] = (even - odd) / np.float32(24.0)
                mixed[5, at, k] = c[k]
    return mixed


@njit(cache=True, fastmath={"contract"})
def _mixed_rows(units: Linear, dilation: int) -> Linear:
    """Combine the rows of each block and its neighbours into bands (BANDS, U, ...) of one row per block."""
    number, high, wide = units.shape
    blocks = (high - 2 * _BORDER) // _HIGH
    bands = np.zeros((_BANDS, number, blocks * wide + 2 * _BORDER), np.float32)
    for unit in range(number):
        for block in range(blocks):
            top = _first_row(block, dilation)
            row0, row1, row2 = units[unit, top - dilation], units[unit, top], units[unit, top + dilation]
            row3, row4 = units[unit, top + 2 * dilation], units[unit, top + 3 * dilation]
            row5 = units[unit, top + 4 * dilation]
            left, right = _BORDER + block * wide, _BORDER + (block + 1) * wide
            band0, band1 = bands[0, unit, left:right], bands[1, unit, left:right]
            band2, band3 = bands[2, unit, left:right], bands[3, unit, left:right]
            band4, band5 = bands[4, unit, left:right], bands[5, unit, left:right]
            for u in range(wide):
                b, c, d, e = row1[u], row2[u], row3[u], row4[u]
                band0[u] = np.float32(4.0) * row0[u] - np.float32(5.0) * c + e
                even, odd = e - np.float32(4.0) * c, d - np.float32(4.0) * b
                band1[u], band2[u] = even + odd, even - odd
                even, odd = e - c, np.float32(2.0) * (d - b)
                band3[u], band4[u] = even + odd, even - odd
                band5[u] = np.float32(4.0) * b - np.float32(5.0) * d + row5[u]
    return bands


@njit(cache=True, fastmath={"contract"})
def _unmix(sums: Linear, units: Linear, biases: Linear, dilation: int, grown: Linear) -> None:
    """Transform the bands back to rows, and add the rectified result to the units."""
    number, _, wide = units.shape
    zero = np.float32(0.0)
    for unit in range(number):
        bias = biases[unit]
        for block in range(sums.shape[2] // wide):
            top = _first_row(block, dilation)
            old0, old1 = units[unit, top], units[unit, top + dilation]
            old2, old3 = units[unit, top + 2 * dilation], units[unit, top + 3 * dilation]
            new0, new1 = grown[unit, top], grown[unit, top + dilation]
            new2, new3 = grown[unit, top + 2 * dilation], grown[unit, top + 3 * dilation]
            left, right = block * wide, (block + 1) * wide
            sum0, sum1, sum2 = sums[0, unit, left:right], sums[1, unit, left:right], sums[2, unit, left:right]
            sum3, sum4, sum5 = sums[3, unit, left:right], sums[4, unit, left:right], sums[5, unit, left:right]
            for u in range(wide):
                even, odd = sum1[u] + sum2[u], sum1[u] - sum2[u]
                even2, odd2 = sum3[u] + sum4[u], np.float32(2.0) * (sum3[u] - sum4[u])
                new0[u] = old0[u] + max(sum0[u] + even + even2 + bias, zero)
                new1[u] = old1[u] + max(odd + odd2 + bias, zero)
                new2[u] = old2[u] + max(even + np.float32(4.0) * even2 + bias, zero)
                new3[u] = old3[u] + max(odd + np.float32(4.0) * odd2 + sum5[u] + bias, zero)


@njit(cache=True, fastmath=False)
def _first_row(block: int, dilation: int) -> int:
    """Return the row of the units in which a block starts."""
    return _BORDER + block // dilation * _HIGH * dilation + block % dilation


@njit(cache=True, fastmath=False)
def _bordered(number: int, rows: int, columns: int) -> Linear:
    whole = _HIGH * _BORDER
    return np.empty((number, -(-rows // whole) * whole + 2 * _BORDER, columns + 2 * _BORDER), np.float32)


@njit(cache=True, fastmath=False)
def _close(units: Linear, rows: int) -> None:
    """Zero the rows above and below the image, and wrap those of the image over the seam."""
    columns = units.shape[2] - 2 * _BORDER
    units[:, :_BORDER] = 0.0
    units[:, rows + _BORDER :] = 0.0
    for unit in range(units.shape[0]):
        for row in range(_BORDER, rows + _BORDER):
            line = units[unit, row]
            for k in range(_BORDER):
                line[k] = line[columns + k]
            for k in range(_BORDER):
                line[columns + _BORDER + k] = line[_BORDER + k]
