import numpy as np
import pytest

from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.patches import integrate, integrate_windows
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS
from tests.helpers.images.drawn_trees import PATCHES, drawn_cells, drawn_patches, seen_in


def test_patches_are_means_of_rectangles_and_their_differences() -> None:
    windows = np.random.default_rng(1).integers(-512, 512, (6, CHANNELS * ROWS * COLUMNS)) / 512.0
    patches, sums = drawn_patches(), integrate_windows(windows.astype(np.float16))
    for number in range(PATCHES):
        expected = [
            seen_in(window.reshape(CHANNELS, ROWS, COLUMNS).astype(np.float32), patches, number)
            for window in windows
        ]
        np.testing.assert_allclose(patches.of(sums, number), expected, atol=1e-5)


def test_no_digits_are_lost_however_large_an_image_is() -> None:
    cells = np.full((CHANNELS, 480, 640), 3.0, np.float32)
    cells[:, -1, -1] = 3.0 + 1.0 / 512.0
    sums = integrate(cells)
    corner = sums[:, -1, -1] - sums[:, -2, -1] - sums[:, -1, -2] + sums[:, -2, -2]
    assert corner.tolist() == [3 * 512 + 1] * CHANNELS


@pytest.mark.parametrize("seed", [0, 1])
def test_sums_are_those_of_all_cells_above_and_to_the_left(seed: int) -> None:
    cells = drawn_cells()
    rng = np.random.default_rng(seed)
    row, column = int(rng.integers(0, 35)), int(rng.integers(0, 28))
    expected = np.rint(cells[:, :row, :column].astype(np.float64) * 512.0).sum(axis=(1, 2))
    assert integrate(cells)[:, row, column].tolist() == expected.tolist()
