"""Convolutions by matrix products, with Winograd filtering for 3 x 3 kernels of stride 1.

F(2 x 2, 3 x 3) takes less than half of the products (Lavin and Gray, CVPR 2016, section 4.1).
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

Planes = NDArray[np.float32]


TILE: Final = 4
"""Side of the tiles [px] of F(2 x 2, 3 x 3); they are 2 px apart and give 2 x 2 px each."""

_AT_HAND: Final = 2**18  # numbers processed at once, so that they stay in the cache
_INTO: Final = np.array([[1.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.0, 1.0]])


class Buffer:
    """Reusable memory: allocating a megabyte costs more than filling it."""

    def __init__(self) -> None:
        self._numbers = np.empty(0, np.float32)

    def take(self, shape: tuple[int, ...]) -> Planes:
        """Return an array, which is valid until the next one is taken."""
        size = math.prod(shape)
        if size > self._numbers.size:
            self._numbers = np.empty(size, np.float32)
        return self._numbers[:size].reshape(shape)


class Workspace:
    """Buffers of consecutive convolutions. An output is valid until the next but one is computed."""

    def __init__(self) -> None:
        self._buffers: defaultdict[str, Buffer] = defaultdict(Buffer)
        self._is_odd = False

    def take_output(self, shape: tuple[int, ...]) -> Planes:
        """Return an array for an output: one of two in turn, as the last output is the next input."""
        self._is_odd = not self._is_odd
        return self.take(f"output {self._is_odd}", shape)

    def take(self, name: str, shape: tuple[int, ...]) -> Planes:
        """Return an array, which is valid until the next one of that name is taken."""
        return self._buffers[name].take(shape)


def convolve(
    planes: Planes, kernel: Planes, bias: Planes, side: int, stride: int, workspace: Workspace
) -> Planes:
    """Convolve planes, and apply a rectified linear unit.

    Args:
        planes: (N, H, W, C), padded with 0.
        kernel: (side side C, K).
        bias: (K,).
        side: of the kernel [px], odd.
        stride: step of the output [px].
        workspace: buffers.

    Returns:
        (N, H', W', K).
    """
    count, high, wide, _ = planes.shape
    rows, columns = -(-high // stride), -(-wide // stride)
    given = workspace.take_output((count, rows * columns, len(bias)))
    for some in _batches(count, rows * columns * len(kernel)):
        seen = workspace.take("patches", (len(planes[some]), rows, columns, len(kernel)))
        _gather(planes[some], side, stride, seen)
        np.matmul(seen.reshape(-1, len(kernel)), kernel, out=given[some].reshape(-1, len(bias)))
    _rectify(given.reshape(-1, len(bias)), bias)
    return given.reshape(count, rows, columns, len(bias))


def _batches(count: int, size: int) -> Iterator[slice]:
    """Return how many items with this many numbers each fit into the cache."""
    step = max(_AT_HAND // size, 1)
    return (slice(first, first + step) for first in range(0, count, step))


def tile_kernel(kernel: Planes) -> Planes:
    """Transform a kernel (9 C, K) to the tile domain, (16, C, K)."""
    square = kernel.reshape(3, 3, -1, kernel.shape[1]).astype(np.float64)
    result = np.einsum("ai,bj,ijck->abck", _INTO, _INTO, square)
    return np.ascontiguousarray(result.reshape(TILE * TILE, *result.shape[2:]), np.float32)


def convolve_tiles(planes: Planes, kernel: Planes, bias: Planes, workspace: Workspace) -> Planes:
    """Convolve as `convolve` with side 3 and stride 1, with a kernel (16, C, K) from `tile_kernel`."""
    count, rows, columns, deep = planes.shape
    right = -(-columns // 2)
    each = -(-rows // 2) * right
    given = workspace.take_output((count, rows, columns, len(bias)))
    for some in _batches(count, TILE * TILE * each * (deep + len(bias))):
        tiles = workspace.take("patches", (TILE * TILE, len(planes[some]) * each, deep))
        _into_tiles(planes[some], right, tiles)
        products = workspace.take("products", (*tiles.shape[:2], len(bias)))
        np.matmul(tiles, kernel, out=products)
        _out_of_tiles(products, bias, right, given[some])
    return given


# Indices are unsigned below, so that the compiler can vectorise the copies.


@njit(cache=True, nogil=True)
def _gather(planes: Planes, side: int, stride: int, seen: Planes) -> None:  # pragma: no cover
    """Gather the inputs of the kernel at each position in a row: `side` contiguous runs."""
    count, rows, columns, _ = seen.shape
    _, high, wide, deep = planes.shape
    put, to, edge = seen.ravel(), np.uint64(0), side // 2
    for number in range(count):
        given = planes[number].ravel()
        for row in range(rows):
            for column in range(columns):
                first = column * stride - edge
                begin, end = max(first, 0), min(first + side, wide)
                before, after = np.uint64((begin - first) * deep), np.uint64((first + side - end) * deep)
                length = np.uint64((end - begin) * deep)
                for line in range(row * stride - edge, row * stride - edge + side):
                    if 0 <= line < high:
                        to = _blank(put, to, before)
                        at = np.uint64((line * wide + begin) * deep)
                        for k in range(length):
                            put[to + k] = given[at + k]
                        to = _blank(put, to + length, after)
                    else:
                        to = _blank(put, to, before + length + after)


@njit(inline="always")
def _blank(put: Planes, to: np.uint64, length: np.uint64) -> np.uint64:  # pragma: no cover
    for k in range(length):
        put[to + k] = np.float32(0.0)
    return to + length


@njit(cache=True, nogil=True)
def _rectify(given: Planes, bias: Planes) -> None:  # pragma: no cover
    for place in range(given.shape[0]):
        for k in range(given.shape[1]):
            given[place, k] = max(given[place, k] + bias[k], np.float32(0.0))


@njit(cache=True, nogil=True)
def _into_tiles(planes: Planes, right: int, tiles: Planes) -> None:  # pragma: no cover
    """Return B' d B of each tile d, separately for each of its 16 numbers."""
    count, high, wide, deep = planes.shape
    each = tiles.shape[1] // count
    edged = np.zeros((TILE, TILE, deep), np.float32)
    half = np.empty((TILE, TILE, deep), np.float32)
    for tile in range(tiles.shape[1]):
        seen, place = planes[tile // each], tile % each
        top, left = 2 * (place // right) - 1, 2 * (place % right) - 1
        for i in range(TILE):
            for j in range(TILE):
                if 0 <= top + i < high and 0 <= left + j < wide:
                    for k in range(deep):
                        edged[i, j, k] = seen[top + i, left + j, k]
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
    """Return A' m A of each tile's products m, plus the bias, rectified."""
    count, high, wide, deep = given.shape
    each = products.shape[1] // count
    half = np.empty((2, TILE, deep), np.float32)
    zero = np.float32(0.0)
    for tile in range(products.shape[1]):
        put, place = given[tile // each], tile % each
        top, left = 2 * (place // right), 2 * (place % right)
        for j in range(TILE):
            for k in range(deep):
                a, b = products[j, tile, k], products[4 + j, tile, k]
                c, d = products[8 + j, tile, k], products[12 + j, tile, k]
                half[0, j, k] = a + b + c
                half[1, j, k] = b - c - d
        for i in range(min(2, high - top)):
            for k in range(deep):
                put[top + i, left, k] = max(half[i, 0, k] + half[i, 1, k] + half[i, 2, k] + bias[k], zero)
            if left + 1 < wide:
                for k in range(deep):
                    result = half[i, 1, k] - half[i, 2, k] - half[i, 3, k]
                    put[top + i, left + 1, k] = max(result + bias[k], zero)
