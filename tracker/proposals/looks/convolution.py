"""Convolutions by matrix products; those of 3 x 3 at every pixel with less than half of the products.

For the latter Winograd's minimal filtering F(2 x 2, 3 x 3) is used (Lavin and Gray, CVPR 2016, section 4.1).
"""

from __future__ import annotations

from collections import defaultdict
from typing import Final

import numpy as np
from numba import njit

from peopleboy.tracker.proposals.channels import Memory
from peopleboy.tracker.proposals.looks.crops import Planes

TILE: Final = 4
"""Side of the tiles [px] that F(2 x 2, 3 x 3) takes, 2 px apart, which give 2 x 2 px each."""

_INTO: Final = np.array([[1.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.0, 1.0]])


class Desk:
    """Room for one convolution after another.

    What a convolution gives holds until the next but one.
    """

    def __init__(self) -> None:
        self._rooms: defaultdict[str, Memory] = defaultdict(Memory)
        self._is_odd = False

    def given(self, shape: tuple[int, ...]) -> Planes:
        """Give an array for what comes out; by turns, as what came out before goes in."""
        self._is_odd = not self._is_odd
        return self.take(f"given {self._is_odd}", shape)

    def take(self, name: str, shape: tuple[int, ...]) -> Planes:
        """Give an array; it holds until the next one of that name is taken."""
        return self._rooms[name].take(shape)


def convolved(planes: Planes, kernel: Planes, bias: Planes, side: int, stride: int, desk: Desk) -> Planes:
    """Convolve planes, and cut off what is below 0.

    Args:
        planes: (H, W, C); beyond their border is 0.
        kernel: (side side C, K).
        bias: (K,).
        side: of the kernel [px], odd.
        stride: pixels between places where it looks.
        desk: where to work.

    Returns:
        (H', W', K).
    """
    high, wide, deep = planes.shape
    rows, columns, edge = -(-high // stride), -(-wide // stride), side // 2
    edged = desk.take("edged", (high + 2 * edge, (wide + 2 * edge) * deep))
    _edge(planes, edge, edged)
    seen = desk.take("seen", (rows * columns, len(kernel)))
    _gather(edged, side, side * deep, stride, stride * deep, columns, seen)
    given = desk.given((rows * columns, len(bias)))
    np.matmul(seen, kernel, out=given)
    _rectify(given, bias)
    return given.reshape(rows, columns, len(bias))


def turned(kernel: Planes) -> Planes:
    """Turn a kernel (9 C, K) into what is multiplied by tiles, (16, C, K)."""
    square = kernel.reshape(3, 3, -1, kernel.shape[1]).astype(np.float64)
    told = np.einsum("ai,bj,ijck->abck", _INTO, _INTO, square)
    return np.ascontiguousarray(told.reshape(TILE * TILE, *told.shape[2:]), np.float32)


def convolved_by_tiles(planes: Planes, kernel: Planes, bias: Planes, desk: Desk) -> Planes:
    """Do what `convolved` does with side 3 and stride 1, by a kernel (16, C, K) that is `turned`."""
    rows, columns, deep = planes.shape
    down, right = -(-rows // 2), -(-columns // 2)
    tiles = desk.take("seen", (TILE * TILE, down * right, deep))
    _into_tiles(planes, right, tiles)
    products = desk.take("products", (TILE * TILE, down * right, len(bias)))
    np.matmul(tiles, kernel, out=products)
    given = desk.given((rows, columns, len(bias)))
    _out_of_tiles(products, bias, right, given)
    return given


# Below, places are unsigned: the compiler copies many numbers at once where none can count from the end.


@njit(cache=True, nogil=True)
def _edge(planes: Planes, edge: int, edged: Planes) -> None:  # pragma: no cover
    """Surround planes by zeros."""
    high, wide, deep = planes.shape
    given, put = planes.ravel(), edged.ravel()
    run, row, begin = np.uint64(wide * deep), np.uint64(edged.shape[1]), np.uint64(edge * deep)
    put[:] = np.float32(0.0)
    for i in range(np.uint64(high)):
        to = (i + np.uint64(edge)) * row + begin
        for k in range(run):
            put[to + k] = given[i * run + k]


@njit(cache=True, nogil=True)
def _gather(
    edged: Planes, side: int, run: int, down: int, right: int, columns: int, seen: Planes
) -> None:  # pragma: no cover
    """Put what the kernel sees at each place into a row: `side` runs of numbers, one below the other."""
    given, put, row = edged.ravel(), seen.ravel(), np.uint64(edged.shape[1])
    to, length = np.uint64(0), np.uint64(run)
    for place in range(len(seen)):
        at = np.uint64(place // columns * down) * row + np.uint64(place % columns * right)
        for _ in range(side):
            for k in range(length):
                put[to + k] = given[at + k]
            to += length
            at += row


@njit(cache=True, nogil=True)
def _rectify(given: Planes, bias: Planes) -> None:  # pragma: no cover
    for place in range(given.shape[0]):
        for k in range(given.shape[1]):
            given[place, k] = max(given[place, k] + bias[k], np.float32(0.0))


@njit(cache=True, nogil=True)
def _into_tiles(planes: Planes, right: int, tiles: Planes) -> None:  # pragma: no cover
    """Give B' d B of each tile d, one of 16 numbers after the other."""
    high, wide, deep = planes.shape
    edged = np.zeros((TILE, TILE, deep), np.float32)
    half = np.empty((TILE, TILE, deep), np.float32)
    for tile in range(tiles.shape[1]):
        top, left = 2 * (tile // right) - 1, 2 * (tile % right) - 1
        for i in range(TILE):
            for j in range(TILE):
                if 0 <= top + i < high and 0 <= left + j < wide:
                    for k in range(deep):
                        edged[i, j, k] = planes[top + i, left + j, k]
                else:
                    edged[i, j] = 0.0
        for j in range(TILE):
            for k in range(deep):
                a, b, c, d = edged[0, j, k], edged[1, j, k], edged[2, j, k], edged[3, j, k]
                half[0, j, k] = a - c
                half[1, j, k] = b + c
                half[2, j, k] = c - b
                half[3, j, k] = b - d
        for i in range(TILE):
            for k in range(deep):
                a, b, c, d = half[i, 0, k], half[i, 1, k], half[i, 2, k], half[i, 3, k]
                tiles[4 * i, tile, k] = a - c
                tiles[4 * i + 1, tile, k] = b + c
                tiles[4 * i + 2, tile, k] = c - b
                tiles[4 * i + 3, tile, k] = b - d


@njit(cache=True, nogil=True)
def _out_of_tiles(products: Planes, bias: Planes, right: int, given: Planes) -> None:  # pragma: no cover
    """Give A' m A of each tile's products m, with the bias, cut off below 0."""
    high, wide, deep = given.shape
    half = np.empty((2, TILE, deep), np.float32)
    zero = np.float32(0.0)
    for tile in range(products.shape[1]):
        top, left = 2 * (tile // right), 2 * (tile % right)
        for j in range(TILE):
            for k in range(deep):
                a, b = products[j, tile, k], products[4 + j, tile, k]
                c, d = products[8 + j, tile, k], products[12 + j, tile, k]
                half[0, j, k] = a + b + c
                half[1, j, k] = b - c - d
        for i in range(min(2, high - top)):
            for k in range(deep):
                given[top + i, left, k] = max(half[i, 0, k] + half[i, 1, k] + half[i, 2, k] + bias[k], zero)
            if left + 1 < wide:
                for k in range(deep):
                    told = half[i, 1, k] - half[i, 2, k] - half[i, 3, k]
                    given[top + i, left + 1, k] = max(told + bias[k], zero)
