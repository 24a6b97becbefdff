"""The small network that tells people from background by what a pixel and its neighbourhood look like."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

Linear = NDArray[np.float32]

BLOCK: Final = 4
"""The network sees and tells squares of so many by so many pixels at once."""
FEATURES: Final = 6
"""What it is told of each pixel: red, green, blue, unlikeness to the background, its age, its doubt."""
INPUTS: Final = BLOCK * BLOCK * FEATURES
OUTPUTS: Final = BLOCK * BLOCK
DILATIONS: Final = (1, 2, 4)
"""How many squares apart the nine are that each of the layers between first and last looks at."""

_BORDER: Final = max(DILATIONS)
TOGETHER: Final = 12
"""What the number of units is a multiple of: they are worked out by fours and read by threes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MaskNetwork:
    """A trained network: it sees a panorama as R rows of squares, each with U units in every layer.

    Columns go on over the seam, so that an image rolled by whole squares gives the same answer, rolled.

    Attributes:
        first: (INPUTS, U) weights of a square's own pixels.
        rows: (R, U) bias of the first layer, by row of squares.
        between: (L, 9, U, U) weights of the layers between, by neighbour from the upper left one on.
        biases: (L, U) of those layers.
        last: (U + INPUTS, OUTPUTS) weights of the last layer, which sees the square's own pixels again.
        bias: (OUTPUTS,) of the last layer.
    """

    first: Linear
    rows: Linear
    between: Linear
    biases: Linear
    last: Linear
    bias: Linear

    def probability(self, squares: Linear) -> Linear:
        """Tell for each pixel (H, W) the probability that it is a person.

        Args:
            squares: (INPUTS, H / BLOCK, W / BLOCK) features of each square, as `compare` gives them.
        """
        units = _look_within(squares, self.first, self.rows)
        for weights, bias, dilation in zip(self.between, self.biases, DILATIONS, strict=True):
            units = _look_round(units, weights, bias, dilation)
        return _tell(units, squares, self.last, self.bias)


@njit(fastmath=True, inline="always")
def _add(
    sums: Linear, a: Linear, b: Linear, c: Linear, by_a: Linear, by_b: Linear, by_c: Linear, unit: int
) -> None:
    """Add three inputs (C,) with their weights to the sums (4, C) of four units from one on.

    So many at once, as each number that is read from memory then serves as often as the processor can use it.
    """
    a0, a1, a2, a3 = by_a[unit], by_a[unit + 1], by_a[unit + 2], by_a[unit + 3]
    b0, b1, b2, b3 = by_b[unit], by_b[unit + 1], by_b[unit + 2], by_b[unit + 3]
    c0, c1, c2, c3 = by_c[unit], by_c[unit + 1], by_c[unit + 2], by_c[unit + 3]
    sum0, sum1, sum2, sum3 = sums[0], sums[1], sums[2], sums[3]
    for u in range(sums.shape[1]):
        x, y, z = a[u], b[u], c[u]
        sum0[u] += a0 * x + b0 * y + c0 * z
        sum1[u] += a1 * x + b1 * y + c1 * z
        sum2[u] += a2 * x + b2 * y + c2 * z
        sum3[u] += a3 * x + b3 * y + c3 * z


@njit(cache=True, fastmath=True)
def _look_within(squares: Linear, weights: Linear, biases: Linear) -> Linear:
    """First layer: (U, R, C) with a border round it that is 0 above and below, and goes over the seam."""
    inputs, rows, columns = squares.shape
    units = _bordered(weights.shape[1], rows, columns)
    sums = np.empty((4, columns), np.float32)
    for row in range(rows):
        for unit in range(0, weights.shape[1], 4):
            for j in range(4):
                sums[j] = biases[row, unit + j]
            for k in range(0, inputs, 3):
                _add(
                    sums, squares[k, row], squares[k + 1, row], squares[k + 2, row],
                    weights[k], weights[k + 1], weights[k + 2], unit,
                )  # fmt: skip
            for j in range(4):
                units[unit + j, row + _BORDER, _BORDER : columns + _BORDER] = np.maximum(
                    sums[j], np.float32(0.0)
                )
    _close(units)
    return units


@njit(cache=True, fastmath=True)
def _look_round(units: Linear, weights: Linear, biases: Linear, dilation: int) -> Linear:
    """A layer between: to each unit is added what it makes of the nine squares round it."""
    number, rows, columns = units.shape[0], units.shape[1] - 2 * _BORDER, units.shape[2] - 2 * _BORDER
    grown = _bordered(number, rows, columns)
    sums = np.empty((4, columns), np.float32)
    left, right = _BORDER - dilation, _BORDER + dilation
    for row in range(rows):
        for unit in range(0, number, 4):
            for j in range(4):
                sums[j] = biases[unit + j]
            for k in range(number):
                for step in range(3):
                    line = units[k, row + _BORDER + (step - 1) * dilation]
                    _add(
                        sums, line[left : left + columns], line[_BORDER : _BORDER + columns],
                        line[right : right + columns],
                        weights[3 * step, k], weights[3 * step + 1, k], weights[3 * step + 2, k], unit,
                    )  # fmt: skip
            for j in range(4):
                old = units[unit + j, row + _BORDER]
                new = grown[unit + j, row + _BORDER]
                for u in range(columns):
                    new[u + _BORDER] = old[u + _BORDER] + max(sums[j, u], np.float32(0.0))
    _close(grown)
    return grown


@njit(cache=True, fastmath=True)
def _tell(units: Linear, squares: Linear, weights: Linear, biases: Linear) -> Linear:
    """Last layer: probabilities (H, W)."""
    inputs, rows, columns = squares.shape
    number = units.shape[0]
    told = np.empty((rows * BLOCK, columns * BLOCK), np.float32)
    sums = np.empty((4, columns), np.float32)
    for row in range(rows):
        for line in range(BLOCK):
            unit = line * BLOCK
            for j in range(4):
                sums[j] = biases[unit + j]
            for k in range(0, number, 3):
                _add(
                    sums, units[k, row + _BORDER, _BORDER : columns + _BORDER],
                    units[k + 1, row + _BORDER, _BORDER : columns + _BORDER],
                    units[k + 2, row + _BORDER, _BORDER : columns + _BORDER],
                    weights[k], weights[k + 1], weights[k + 2], unit,
                )  # fmt: skip
            for k in range(0, inputs, 3):
                _add(
                    sums, squares[k, row], squares[k + 1, row], squares[k + 2, row],
                    weights[number + k], weights[number + k + 1], weights[number + k + 2], unit,
                )  # fmt: skip
            for u in range(columns):
                for j in range(4):
                    told[row * BLOCK + line, u * BLOCK + j] = np.float32(1.0) / (
                        np.float32(1.0) + np.exp(-sums[j, u])
                    )
    return told


@njit(cache=True)
def _bordered(number: int, rows: int, columns: int) -> Linear:
    units = np.empty((number, rows + 2 * _BORDER, columns + 2 * _BORDER), np.float32)
    units[:, :_BORDER] = 0.0
    units[:, rows + _BORDER :] = 0.0
    return units


@njit(cache=True)
def _close(units: Linear) -> None:
    """Carry rows on over the seam."""
    columns = units.shape[2] - 2 * _BORDER
    inner = units[:, _BORDER:-_BORDER]
    inner[:, :, :_BORDER] = inner[:, :, columns : columns + _BORDER]
    inner[:, :, columns + _BORDER :] = inner[:, :, _BORDER : 2 * _BORDER]
