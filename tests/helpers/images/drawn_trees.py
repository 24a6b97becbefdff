"""Trees of the detector of people, drawn at random."""

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, BoxRegression
from peopleboy.tracker.sensors.thermal.detector.cascade import Cascade
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.patches import Patches
from peopleboy.tracker.sensors.thermal.detector.vector_trees import LEAVES, NODES
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS as WINDOW_COLUMNS
from peopleboy.tracker.sensors.thermal.detector.window import ROWS as WINDOW_ROWS

TREES = 40
PLACING_TREES = 7
PATCHES = 300
ROWS, COLUMNS = 34, 27
Cells = NDArray[np.float32]


def drawn_patches() -> Patches:
    """300 pairs of rectangles; of every third one there is no second."""
    rng = np.random.default_rng(3)

    def boxes() -> NDArray[np.uint8]:
        ends = [np.sort(rng.integers(0, end, (PATCHES, 2)), axis=1) for end in (WINDOW_ROWS, WINDOW_COLUMNS)]
        (top, bottom), (left, right) = (pair.T for pair in ends)
        return np.stack([top, left, bottom + 1, right + 1], axis=1).astype(np.uint8)

    second = boxes()
    second[::3] = 0
    return Patches(rng.integers(0, CHANNELS, PATCHES).astype(np.uint8), boxes(), second)


def drawn_cascade(least: float = -np.inf) -> Cascade:
    """40 trees, after each of which it takes so much to go on."""
    tables = drawn_tables((TREES,), np.random.default_rng(4))
    return Cascade(drawn_patches(), *tables, np.full(TREES, least, np.float32))


def drawn_placing() -> BoxRegression:
    """7 trees for each number, whose boxes are about as large as their windows."""
    feature, threshold, leaf = drawn_tables((OFFSETS, PLACING_TREES), np.random.default_rng(7))
    return BoxRegression(drawn_patches(), feature, threshold, leaf * np.float32(0.05))


def drawn_tables(trees: tuple[int, ...], rng: np.random.Generator) -> tuple[NDArray[np.int32], Cells, Cells]:
    """Features, thresholds and leaves of so many trees."""
    return (
        rng.integers(0, PATCHES, (*trees, NODES)).astype(np.int32),
        (0.3 * rng.normal(size=(*trees, NODES))).astype(np.float32),
        rng.normal(size=(*trees, LEAVES)).astype(np.float32),
    )


def drawn_cells() -> Cells:
    """(9, 34, 27) channels, whose numbers integral images hold exactly."""
    cells = np.random.default_rng(5).normal(size=(CHANNELS, ROWS, COLUMNS))
    return (np.rint(cells * 512.0) / 512.0).astype(np.float32)


def seen_in(window: Cells, patches: Patches, number: int) -> float:
    """Take the mean of a rectangle of a window (9, 20, 10), less that of another, if there is one."""
    means = [
        float(window[patches.channel[number], top:bottom, left:right].astype(np.float64).mean())
        for top, left, bottom, right in (patches.first[number].tolist(), patches.second[number].tolist())
        if bottom > top
    ]
    return means[0] - sum(means[1:])


def sums_of(
    window: Cells, patches: Patches, feature: NDArray[np.int32], threshold: Cells, leaf: Cells
) -> list[float]:
    """Walk down the trees one after another; give what they add up to after each."""
    sums, total = [], 0.0
    for number in range(len(feature)):
        node = 0
        while node < NODES:
            seen = seen_in(window, patches, feature[number, node])
            node = 2 * node + (2 if seen > threshold[number, node] else 1)
        total += float(leaf[number, node - NODES])
        sums.append(total)
    return sums
