"""Boosted trees of depth 3 on eight windows at once, by vector instructions.

A compiler does not vectorise a tree by itself, as each window reads other nodes. Here all nodes of a tree are
evaluated for all windows. Each window goes through the same operations as alone, so scores are the same on
every processor.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS, Cells
from peopleboy.tracker.sensors.thermal.detector.patches import CORNERS, Patches, Sums
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS

DEPTH: Final = 3
NODES: Final = 2**DEPTH - 1
LEAVES: Final = 2**DEPTH
LANES: Final = 8
"""Number of windows at once."""
PACKED: Final = CHANNELS * (ROWS + 1) * (COLUMNS + 1) * LANES
"""Size of the memory for `pack`."""

_intrinsic: Any = intrinsic  # its types do not fit the functions that it makes
_BLOCKS: Final = (0, 4, COLUMNS - 3)  # first columns of four that are packed at once; the last ones overlap
_INT, _LONG, _FLOAT = ir.IntType(32), ir.IntType(64), ir.FloatType()
_INTS, _FLOATS, _BLOCK = ir.VectorType(_INT, LANES), ir.VectorType(_FLOAT, LANES), ir.VectorType(_INT, 4)


class Trees(NamedTuple):
    """Trees with the positions of what their nodes read.

    Attributes:
        offset: (T * 7, 8) uint32 corners of each node's patch, relative to the first cell of a window.
        weight: (T * 7, 2) float32 factors of the patch.
        threshold: (T * 7,) float32.
        leaf: (T * 8,) float32.
    """

    offset: NDArray[np.uint32]
    weight: Cells
    threshold: Cells
    leaf: Cells

    @classmethod
    def packed(cls, patches: Patches, feature: NDArray[np.int32], threshold: Cells, leaf: Cells) -> "Trees":
        """Make trees, with nodes (..., 7) and leaves (..., 8), that read the windows of `pack`."""
        offset, weight = patches.corners(feature.ravel(), ROWS + 1, COLUMNS + 1)
        return cls(offset * np.uint32(LANES), weight, threshold.ravel(), leaf.ravel())


@_intrinsic
def add_tree(
    _typing: Any, sums: Any, at: Any, trees: Any, tree: Any, limit: Any, score: Any
) -> tuple[Any, Any]:
    """Add the leaves of a tree to scores (8,), and return the set of windows whose score is at least a limit.

    Window k starts at the position `at + k` in sums, and is bit k of the set.
    """

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        tables = [builder.extract_value(args[2], k) for k in range(len(Trees._fields))]
        offset, weight, threshold, leaf = (
            _pointer(context, builder, kind, table)
            for kind, table in zip(signature.args[2].types, tables, strict=True)
        )
        first = builder.gep(_pointer(context, builder, signature.args[0], args[0]), [args[1]])

        def number(array: Any, row: Any, column: int, columns: int) -> Any:
            index = builder.add(builder.mul(row, _LONG(columns)), _LONG(column))
            return builder.load(builder.gep(array, [index]))

        def rectangle(node: Any, side: int) -> Any:
            a, b, c, d = (
                _load(builder, first, builder.zext(number(offset, node, 4 * side + k, CORNERS), _LONG), _INTS)
                for k in range(4)
            )
            total = builder.sitofp(builder.add(builder.sub(builder.sub(a, b), c), d), _FLOATS)
            return builder.fmul(total, _spread(builder, number(weight, node, side, 2)))

        def is_right(node: Any) -> Any:
            seen = builder.fsub(rectangle(node, 0), rectangle(node, 1))
            return builder.fcmp_ordered(">", seen, _spread(builder, number(threshold, node, 0, 1)))

        def leaf_below(node: int) -> Any:
            if node >= NODES:
                return _spread(builder, number(leaf, args[3], node - NODES, LEAVES))
            return builder.select(right[node], leaf_below(2 * node + 2), leaf_below(2 * node + 1))

        nodes = builder.mul(args[3], _LONG(NODES))
        right = [is_right(builder.add(nodes, _LONG(k))) for k in range(NODES)]
        scores = _pointer(context, builder, signature.args[5], args[5])
        total = builder.fadd(_load(builder, scores, _LONG(0), _FLOATS), leaf_below(0))
        _store(builder, total, scores, _LONG(0))
        is_kept = builder.fcmp_ordered(">=", total, _spread(builder, args[4]))
        return builder.bitcast(is_kept, ir.IntType(LANES))

    return types.uint8(sums, at, trees, tree, limit, score), generate


@_intrinsic
def _pack_row(_typing: Any, sums: Any, at: Any, shift: Any, packed: Any, to: Any) -> tuple[Any, Any]:
    """Pack a row of eight windows at positions (8,), given its position in a window and in the result."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        given, places, put = (_pointer(context, builder, signature.args[k], args[k]) for k in (0, 1, 3))
        begin = [builder.add(builder.load(builder.gep(places, [_LONG(k)])), args[2]) for k in range(LANES)]
        for column in _BLOCKS:
            block = [_load(builder, given, builder.add(place, _LONG(column)), _BLOCK) for place in begin]
            rows = [_mixed(builder, block[k], block[k + 4], range(LANES)) for k in range(4)]
            for _ in range(2):  # to interleave rows twice transposes them
                rows = [
                    _mixed(builder, rows[k], rows[k + 2], order)
                    for k in range(2)
                    for order in ((0, 8, 1, 9, 4, 12, 5, 13), (2, 10, 3, 11, 6, 14, 7, 15))
                ]
            for k, row in enumerate(rows):
                _store(builder, row, put, builder.add(args[4], _LONG(LANES * (column + k))))
        return context.get_dummy_value()

    return types.void(sums, at, shift, packed, to), generate


@njit(cache=True, nogil=True)
def pack(
    sums: Sums, high: int, wide: int, at: NDArray[np.uint64], packed: NDArray[np.int32]
) -> None:  # pragma: no cover
    """Copy windows at up to eight positions in sums of `high` by `wide`, with their numbers alternating."""
    eight, to = np.empty(LANES, np.uint64), np.uint64(0)
    for lane in range(LANES):
        eight[lane] = at[min(lane, len(at) - 1)]
    for channel in range(CHANNELS):
        for row in range(channel * high, channel * high + ROWS + 1):
            _pack_row(sums, eight, np.uint64(row * wide), packed, to)
            to += np.uint64(LANES * (COLUMNS + 1))


def _pointer(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    return context.make_array(kind)(context, builder, array).data


def _load(builder: Any, array: Any, index: Any, kind: Any) -> Any:
    place = builder.bitcast(builder.gep(array, [index]), kind.as_pointer())
    return builder.load(place, align=4)


def _store(builder: Any, vector: Any, array: Any, index: Any) -> None:
    place = builder.bitcast(builder.gep(array, [index]), vector.type.as_pointer())
    builder.store(vector, place, align=4)


def _spread(builder: Any, number: Any) -> Any:
    """Return eight times the same number."""
    one = builder.insert_element(ir.Constant(_FLOATS, ir.Undefined), number, _INT(0))
    return _mixed(builder, one, one, [0] * LANES)


def _mixed(builder: Any, first: Any, second: Any, order: Any) -> Any:
    """Return eight numbers of two vectors, by their numbers in both."""
    return builder.shuffle_vector(first, second, ir.Constant(_INTS, list(order)))
