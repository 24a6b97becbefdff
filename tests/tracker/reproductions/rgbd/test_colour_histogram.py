"""Histograms of hue and saturation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.tracker.reproductions.rgbd.observation_model import (
    BINS,
    HUES,
    SATURATIONS,
    bin_of_colour,
    colours_in,
    similarity,
)
from peopleboy.tracker.sensors.depth.depth_view import RgbdView
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view
from tests.helpers.images.as_taken import as_taken

histograms = arrays(np.float64, BINS, elements=st.floats(0.01, 1.0)).map(lambda one: one / one.sum())


def bin_of(red: int, green: int, blue: int) -> int:
    return int(bin_of_colour()[(red >> 3) << 10 | (green >> 3) << 5 | blue >> 3])


def test_colours_without_hue_have_bins_by_brightness() -> None:
    greys = [bin_of(level, level, level) for level in (10, 90, 150, 240)]
    assert greys == [HUES * SATURATIONS + k for k in range(4)]


def test_hues_have_bins_of_their_own() -> None:
    assert len({bin_of(220, 20, 20), bin_of(20, 220, 20), bin_of(20, 20, 220), bin_of(220, 220, 20)}) == 4


@settings(deadline=None)
@given(one=histograms, other=histograms)
def test_similarity_is_one_for_equals_and_less_for_others(one: np.ndarray, other: np.ndarray) -> None:
    assert similarity(one, one) == pytest.approx(1.0)
    assert 0.0 < similarity(one, other) <= 1.0 + 1e-9
    assert similarity(one, other) == pytest.approx(similarity(other, one))


def test_only_the_nearer_of_two_depths_is_looked_at() -> None:
    depth = depth_of([Block(0.0, 3.0)])
    colour = np.full((HEIGHT, WIDTH, 3), (220, 20, 20), np.uint8)
    colour[depth == 3000] = (20, 20, 220)
    appearance = colours_in(RgbdView(depth, as_taken(colour), make_view(), 0.0), (120.0, 80.0, 80.0, 70.0))
    assert appearance[bin_of(20, 20, 220)] == pytest.approx(1.0, abs=0.02)
    assert appearance.sum() == pytest.approx(1.0)
