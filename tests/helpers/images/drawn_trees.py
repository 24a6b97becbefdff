"""Trees of the detector of people, drawn at random."""

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.proposals.cascade import FEATURES, LEAVES, NODES, Cascade
from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.placing import OFFSETS, Placing

TREES = 40
PLACING_TREES = 7
ROWS, COLUMNS = 34, 27
Cells = NDArray[np.float32]


def drawn_cascade(least: float = -np.inf) -> Cascade:
    """40 trees, after each of which it takes so much to go on."""
    tables = drawn_tables((TREES,), np.random.default_rng(4))
    return Cascade(*tables, np.full(TREES, least, np.float32))


def drawn_placing() -> Placing:
    """7 trees for each number, whose boxes are about as large as their windows."""
    feature, threshold, leaf = drawn_tables((OFFSETS, PLACING_TREES), np.random.default_rng(7))
    return Placing(feature, threshold, leaf * np.float32(0.05))


def drawn_tables(trees: tuple[int, ...], rng: np.random.Generator) -> tuple[NDArray[np.int32], Cells, Cells]:
    """Features, thresholds and leaves of so many trees."""
    return (
        rng.integers(0, FEATURES, (*trees, NODES)).astype(np.int32),
        rng.normal(size=(*trees, NODES)).astype(np.float32),
        rng.normal(size=(*trees, LEAVES)).astype(np.float32),
    )


def drawn_cells() -> Cells:
    """(9, 34, 27) channels."""
    return np.random.default_rng(5).normal(size=(CHANNELS, ROWS, COLUMNS)).astype(np.float32)


def sums_of(window: Cells, feature: NDArray[np.int32], threshold: Cells, leaf: Cells) -> list[float]:
    """Walk down the trees one after another; give what they add up to after each."""
    sums, total = [], 0.0
    for number in range(len(feature)):
        node = 0
        while node < NODES:
            is_right = window.ravel()[feature[number, node]] > threshold[number, node]
            node = 2 * node + (2 if is_right else 1)
        total += float(leaf[number, node - NODES])
        sums.append(total)
    return sums
