import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.studies.training.detector.boosting import Binned, Boosting, Tables
from peopleboy.studies.training.detector.mining import CELLS
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, integrate_windows

Floats = NDArray[np.float32]
ONE = Boosting(1, 0.5, features=60, share=1.0, smallest=5)


def binned(windows: NDArray[np.float16], rng: np.random.Generator) -> Binned:
    """Bins of windows that differ in the twelve first cells of the first column alone."""
    whole = np.zeros((len(windows), CELLS), np.float16)
    whole[:, :120:10] = windows
    first = np.array([(row, 0, row + 1, 1) for row in range(12)], np.uint8)
    patches = Patches(np.zeros(12, np.uint8), first, np.zeros((12, 4), np.uint8))
    return Binned(patches, integrate_windows(whole), rng)


def told(tables: Tables, windows: NDArray[np.float16]) -> Floats:
    """What trees say of windows, node by node."""
    sums = np.zeros(len(windows), np.float32)
    for feature, threshold, leaf in zip(*tables, strict=True):
        for k, window in enumerate(windows.astype(np.float32)):
            node = 0
            for _ in range(3):
                node = 2 * node + 1 + int(window[feature[node]] > threshold[node])
            sums[k] += leaf[node - 7]
    return sums


@pytest.fixture
def windows() -> NDArray[np.float16]:
    return (np.random.default_rng(1).integers(-1024, 1024, (400, 12)) / 512.0).astype(np.float16)


def test_a_tree_says_half_of_newtons_step_in_each_leaf(windows: NDArray[np.float16]) -> None:
    is_person = np.arange(400) < 100
    windows[:, 5] = is_person

    def loss(_: Floats) -> tuple[Floats, Floats]:
        return (is_person - 0.5).astype(np.float32), np.full(400, 0.25, np.float32)

    rng = np.random.default_rng(0)
    found = told(binned(windows, rng).boost(loss, ONE, rng), windows)
    np.testing.assert_allclose(found[is_person].sum(), 0.5 * 100 * _step(100), rtol=0.02)
    assert (found[is_person] > 0.8).all()
    assert (found[~is_person] < -0.4).all()


def _step(windows: int) -> float:
    return 0.5 * windows / (0.25 * windows + 1.0)


def test_squares_become_small_tree_by_tree(windows: NDArray[np.float16]) -> None:
    both = (windows[:, 2] > 0.3) + windows[:, 7] * (windows[:, 3] > 0.0)
    target: Floats = both.astype(np.float32)

    def loss(sums: Floats) -> tuple[Floats, Floats]:
        return target - sums, np.ones_like(sums)

    left = []
    for trees in (1, 10, 60):
        rng = np.random.default_rng(0)
        sums = told(
            binned(windows, rng).boost(loss, Boosting(trees, 0.3, 12, smallest=5), rng, start=0.5), windows
        )
        left.append(float(np.square(target - 0.5 - sums).mean()))
    assert left[0] > left[1] > left[2]
    assert left[2] < 0.1 * target.var()


def test_features_that_never_differ_split_nothing() -> None:
    rng = np.random.default_rng(0)
    tables = binned(np.zeros((50, 12), np.float16), rng).boost(
        lambda sums: (np.float32(1.0) - sums, np.ones_like(sums)), ONE, rng
    )
    assert np.isinf(tables.threshold).all()
    np.testing.assert_allclose(told(tables, np.ones((1, 12), np.float16)), 0.5 * 50 / 51)
