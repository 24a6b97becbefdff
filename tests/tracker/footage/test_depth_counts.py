from pathlib import Path

import numpy as np
import pytest

from peopleboy.tracker.footage.depth_counts import DepthCounts
from tests.helpers.calls.refused import refused

FOLDER = Path("clip/depth")


@pytest.mark.parametrize("m_per_count", [0.001, 0.0002, 0.00025, 0.0123])
def test_counts_times_the_scale_are_metres_and_nothing_read_stays_so(m_per_count: float) -> None:
    counts = np.array([[0, 1, 1000], [5000, 20000, 65535]], np.uint16)
    told = DepthCounts(FOLDER, m_per_count)(counts)
    metres = counts * m_per_count
    assert told.dtype == np.uint16
    assert told / 1000 == pytest.approx(np.where(metres <= 65.535, metres, 0.0), abs=0.0005001)


@pytest.mark.parametrize("m_per_count", [0.0, -0.001, float("nan"), float("inf")])
def test_a_scale_that_is_none_is_refused(m_per_count: float) -> None:
    with refused("--depth-scale", "above 0", f"{m_per_count:g}"):
        DepthCounts(FOLDER, m_per_count)


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_pictures_of_other_depths_than_counts_are_refused(dtype: type) -> None:
    with refused(str(FOLDER), "16-bit", np.dtype(dtype).name):
        DepthCounts(FOLDER, 0.001)(np.ones((4, 5), dtype))


def test_a_scale_by_which_nobody_can_be_there_is_refused_with_the_one_that_fits() -> None:
    millimetres = np.full((30, 40), 4000, np.uint16)
    with refused("--depth-scale 1:", "4e+03 m", "--depth-scale 0.001?"):
        DepthCounts(FOLDER, 1.0).check_plausible(millimetres)
    with refused("--depth-scale 1e-05:", "--depth-scale 0.001?"):
        DepthCounts(FOLDER, 1e-5).check_plausible(millimetres)
    with refused("--depth-scale 0.001:", "--depth-scale 0.0002?"):
        DepthCounts(FOLDER, 0.001).check_plausible(np.full((30, 40), 50000, np.uint16))
    DepthCounts(FOLDER, 0.001).check_plausible(millimetres)
    DepthCounts(FOLDER, 1.0).check_plausible(np.zeros((30, 40), np.uint16))
