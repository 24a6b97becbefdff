from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

from peopleboy.tracker.footage.grey import AROUND, GREYS, NOISE, AutomaticGrey, local_grey, noise_of

NOISE_K = 0.05


def room(*, warmer_k: float, lamp_c: float | None = None) -> np.ndarray:
    """Somebody in front of a wall of 30 degC warmer on the left, perhaps by a lamp."""
    values = np.random.default_rng(0).normal(30.0, NOISE_K, (120, 160))
    values[:, :80] += 2.0
    values[40:100, 110:130] += warmer_k
    if lamp_c is not None:
        values[10:18, 20:60] = lamp_c
    return values.astype(np.float32)


def contrast(grey: np.ndarray) -> float:
    """How many greys somebody differs from the wall beside."""
    return float(grey[50:90, 112:128].mean() - grey[50:90, 136:150].mean())


@given(gain=st.floats(0.01, 1000.0), offset=st.floats(-300.0, 300.0))
def test_greys_depend_neither_on_the_unit_nor_on_how_warm_all_is(gain, offset):
    values = room(warmer_k=1.0)
    converted = (gain * (values.astype(np.float64) + offset)).astype(np.float32)
    assert np.abs(local_grey(values).astype(int) - local_grey(converted)).max() <= 2


@pytest.mark.parametrize("warmer_k", [-1.0, 1.0])
def test_a_lamp_makes_nobody_faint(warmer_k):
    alone, lit = room(warmer_k=warmer_k), room(warmer_k=warmer_k, lamp_c=60.0)
    assert contrast(local_grey(lit)) == pytest.approx(contrast(local_grey(alone)), rel=0.35)
    assert abs(contrast(local_grey(lit))) > 3.0 * abs(contrast(AutomaticGrey()(lit)))


def test_warm_stays_more_than_cold():
    assert contrast(local_grey(room(warmer_k=1.0))) > 20.0
    assert contrast(local_grey(room(warmer_k=-1.0))) < -20.0


def test_a_bare_wall_stays_one():
    wall = np.random.default_rng(0).normal(20.0, NOISE_K, (120, 160)).astype(np.float32)
    assert noise_of(wall) == pytest.approx(NOISE_K, rel=0.03)
    assert local_grey(wall).std() == pytest.approx(GREYS / NOISE, rel=0.05)


def test_a_picture_of_one_value_is_one_grey():
    assert np.unique(local_grey(np.full((60, 80), 21.0, np.float32))).tolist() == [128]


def test_greys_are_deviations_of_what_is_around():
    values = room(warmer_k=6.0).astype(np.float64)
    wide = AROUND * values.shape[0]
    away = values - gaussian_filter(values, wide, mode="mirror")
    square = np.minimum(away**2, np.quantile(away**2, 0.95))
    deviation = np.sqrt(gaussian_filter(square, wide, mode="mirror"))
    deviation = np.maximum(deviation, NOISE * noise_of(values.astype(np.float32)))
    told = local_grey(values.astype(np.float32))
    assert np.abs(told - np.clip(128.0 + GREYS * away / deviation, 0.0, 255.0)).max() < 2.0
