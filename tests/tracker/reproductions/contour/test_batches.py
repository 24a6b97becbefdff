"""What kernels do for many samples at once equals what is done one by one, or by numpy, to the last bit."""

import numpy as np
import pytest

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import AppearanceView
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView
from peopleboy.tracker.reproductions.contour.colour_config import (
    FAR_AFFINE,
    ROBOT_PARALLAX,
    ColourDescriptorConfig,
)
from peopleboy.tracker.reproductions.contour.contour_config import AppearanceConfig
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    COVERED,
    ContourModel,
    clutter_of,
    pixels_under,
    probability,
    seen_shares,
)
from peopleboy.tracker.reproductions.contour.variants import CONTOUR

SHAPE = (240, 320)
RNG = np.random.default_rng(7)
IMAGE = RNG.integers(0, 256, SHAPE, dtype=np.uint8)
MODEL = ContourModel.build(SHAPE, CONTOUR.contour)


def brood(parents=60, children=4):
    """Draw samples as resampling leaves them: in d alone unlike their siblings, but for every fifth."""
    each = RNG.uniform([-20, -20, 4, 10], [340, 260, 30, 90], (parents, 4))
    state = np.zeros((parents * children, 9), dtype=np.float32)
    state[:, :4] = np.repeat(each, children, axis=0)
    state[:, 4] = RNG.normal(0, 5, len(state))
    state[::5, 2:4] *= RNG.uniform(0.7, 1.4, len(state[::5]))[:, None]
    return state


@pytest.mark.parametrize("covered", [None, 0.4])
def test_samples_are_measured_together_as_each_alone(covered: float | None) -> None:
    state = brood()
    alone = [MODEL.differences(IMAGE, sample[None], covered)[0] for sample in state]
    assert np.array_equal(MODEL.differences(IMAGE, state, covered), alone)


def test_samples_are_described_together_as_each_alone() -> None:
    config = ColourDescriptorConfig(representation="moments1", affine=FAR_AFFINE, parallax=ROBOT_PARALLAX)
    colour = ColourView.build(RNG.integers(0, 256, (*SHAPE, 3), dtype=np.uint8), SHAPE, config)
    appearance, state = AppearanceView.build(IMAGE, colour, AppearanceConfig()), brood()
    alone = [appearance.describe(sample[None])[0] for sample in state]
    assert np.array_equal(appearance.describe(state), alone, equal_nan=True)


def test_the_shares_in_view_are_those_of_the_pixels_under_the_points() -> None:
    probes, marked = MODEL.probes, IMAGE.copy()
    marked[100:140, 100:200] = COVERED
    for sample in brood(parents=15):
        at = pixels_under(sample, probes, SHAPE)
        is_seen = (at >= 0) & (marked.reshape(-1)[at] != COVERED)
        pairs = is_seen[: len(probes.section)] & is_seen[len(probes.section) :]
        expected = [pairs[probes.section == section].mean() for section in range(8)]
        assert np.array_equal(seen_shares(marked, sample, probes), expected)


def test_clutter_is_the_difference_that_three_quarters_of_the_pairs_do_not_exceed() -> None:
    rows, columns = IMAGE[::4].astype(int), IMAGE[:, ::4].astype(int)
    apart = np.concatenate(
        [np.abs(rows[:, 8:] - rows[:, :-8]).ravel(), np.abs(columns[8:] - columns[:-8]).ravel()]
    )
    clutter = clutter_of(IMAGE)
    assert np.mean(apart <= clutter) >= 0.75 > np.mean(apart <= clutter - 1)


def test_probability_is_the_logistic_function_to_a_float32() -> None:
    fit = RNG.normal(0.4, 3.0, 1000).astype(np.float32)
    odds = np.clip(np.float32(2 * 6.0) * (fit - np.float32(0.45)), -40, 40).astype(float)
    np.testing.assert_allclose(probability(fit, CONTOUR.likelihood), 1 / (1 + np.exp(-odds)), rtol=4e-7)
