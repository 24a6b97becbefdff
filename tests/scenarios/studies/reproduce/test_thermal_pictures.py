from __future__ import annotations

import numpy as np
import pytest

from peopleboy.scenarios.studies.reproduce.pictures.thermal_contours import fitness_grey
from peopleboy.scenarios.studies.reproduce.pictures.time_ranges import stretches
from peopleboy.tracker.thermal.particles import draw_prior
from peopleboy.tracker.thermal.variants import THESIS


@pytest.mark.parametrize(
    ("frames", "found"),
    [([], []), ([4], [(4, 4)]), ([1, 2, 3, 7, 8, 10], [(1, 3), (7, 8), (10, 10)])],
)
def test_frames_fall_into_unbroken_stretches(frames: list[int], found: list[tuple[int, int]]) -> None:
    assert list(stretches(frames)) == found


def test_where_nothing_differs_nothing_fits_and_no_fit_is_beyond_the_cap() -> None:
    rng = np.random.default_rng(0)
    samples = draw_prior(200, (240, 320), THESIS.motion, THESIS.detector, rng)
    assert np.all(fitness_grey(np.full((240, 320), 90, np.uint8), samples) == 0.0)
    noise = rng.integers(0, 240, (240, 320)).astype(np.uint8)
    assert 0.0 < np.abs(fitness_grey(noise, samples)).max() <= 40.0
