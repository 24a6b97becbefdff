import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstat

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.appearance.colour_histograms import cumulative_histograms
from peopleboy.tracker.reproductions.contour.appearance.colour_view import (
    PowerSums,
    normalised_moments,
)

HEIGHT, WIDTH = 24, 32
PICTURE = np.random.default_rng(0).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
SUMS = PowerSums.build(PICTURE, 3)

edges = st.tuples(st.integers(-10, 45), st.integers(-10, 35))
rectangles = st.tuples(edges, edges).map(
    lambda corners: [*np.minimum(*corners).tolist(), *np.maximum(*corners).tolist()]
)


def pixels_in(bounds: list[int], picture: np.ndarray = PICTURE) -> np.ndarray:
    left, top, right, bottom = np.maximum(bounds, 0)
    return picture[top:bottom, left:right].astype(np.int64)


@settings(deadline=None)
@given(rectangles)
def test_sums_over_a_rectangle_are_those_of_its_pixels_inside_the_image(bounds):
    sums = SUMS.over(np.array([bounds], np.int32))
    inside = pixels_in(bounds)
    assert sums.pixels[0] == inside.shape[0] * inside.shape[1]
    assert sums.area[0] == (bounds[2] - bounds[0]) * (bounds[3] - bounds[1])
    for k in range(3):
        assert np.array_equal(sums.power[0, :, k], (inside ** (k + 1)).sum(axis=(0, 1)))


def test_sums_stay_exact_in_a_large_white_picture():
    white = PowerSums.build(np.full((1000, 1200, 1), 255, np.uint8), 3)
    sums = white.over(np.array([[0, 0, 1200, 1000]], np.int32))
    assert sums.power[0, 0].tolist() == [1_200_000 * 255**k for k in (1, 2, 3)]


@given(rectangles)
def test_the_first_powers_sum_to_the_same_alone_and_with_higher_ones(bounds):
    alone = PowerSums.build(PICTURE, 1).over(np.array([bounds], np.int32))
    assert np.array_equal(alone.power[..., 0], SUMS.over(np.array([bounds], np.int32)).power[..., 0])


def test_first_powers_stay_exact_in_the_largest_white_picture():
    white = PowerSums.build(np.full((2048, 4096, 1), 255, np.uint8), 1)
    assert white.over(np.array([[0, 0, 4096, 2048]], np.int32)).power.item() == 2048 * 4096 * 255


@settings(deadline=None)
@given(rectangles)
def test_moments_are_scipys_k_statistics_in_the_thesis_normalisation(bounds):
    moments = normalised_moments(SUMS.over(np.array([bounds], np.int32)), 0.0)
    inside = pixels_in(bounds).reshape(-1, 3) / 255
    if len(inside) == 0:
        assert np.isnan(moments).all()
        return
    for channel in range(3):
        k1, k2, k3 = (kstat(inside[:, channel], n) if len(inside) >= n else 0.0 for n in (1, 2, 3))
        expected = [k1, k2 / k1 if k1 else 0.0, k3 / k2**1.5 if k2 else 0.0]
        assert moments[0, channel] == pytest.approx(expected, rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("grey", [0, 1, 77, 255])
def test_a_plain_region_has_its_level_and_no_other_moment(grey):
    sums = PowerSums.build(np.full((40, 50, 1), grey, np.uint8), 3)
    moments = normalised_moments(sums.over(np.array([[3, 4, 45, 37]], np.int32)), 0.0)
    assert moments[0, 0] == pytest.approx([grey / 255, 0, 0])


@pytest.mark.parametrize(("wide", "known"), [(1, 1), (2, 2), (3, 3)])
def test_a_region_of_n_pixels_has_n_moments(wide, known):
    sums = PowerSums.build(np.array([[[10], [50], [200]]], np.uint8), 3)
    moments = normalised_moments(sums.over(np.array([[0, 0, wide, 1]], np.int32)), 0.0)[0, 0]
    assert np.count_nonzero(moments) == known
    assert np.isfinite(moments).all()


def test_moments_do_not_change_when_a_pattern_is_repeated_but_for_the_small_sample_factors():
    pattern = np.random.default_rng(1).integers(0, 256, (20, 20, 1), dtype=np.uint8)
    whole = np.array([[0, 0, 10_000, 10_000]], np.int32)
    one, many = (
        normalised_moments(PowerSums.build(picture, 3).over(whole), 0.0)
        for picture in (pattern, np.tile(pattern, (5, 5, 1)))
    )
    assert np.allclose(one, many, rtol=0.01)


@settings(deadline=None)
@given(rectangles, rectangles)
def test_a_hole_takes_its_pixels_out_of_the_sums_and_of_the_histograms(bounds, hole):
    start = np.maximum(bounds[:2], hole[:2])
    hole = [*start, *np.maximum(np.minimum(bounds[2:], hole[2:]), start)]
    rows, gaps = np.array([bounds], np.int32), np.array([hole], np.int32)
    is_in = np.zeros((HEIGHT, WIDTH), bool)
    is_in[slice(*np.maximum(bounds[1::2], 0)), slice(*np.maximum(bounds[::2], 0))] = True
    is_in[slice(*np.maximum(hole[1::2], 0)), slice(*np.maximum(hole[::2], 0))] = False
    kept = PICTURE[is_in]
    sums = SUMS.over(rows) - SUMS.over(gaps)
    assert sums.pixels[0] == len(kept)
    assert np.array_equal(sums.power[0, :, 0], kept.sum(axis=0, dtype=np.int64))
    histogram = cumulative_histograms(PICTURE, rows, gaps, 20, 0.0)[0]
    if len(kept) == 0:
        assert np.isnan(histogram).all()
        return
    for channel in range(3):
        counts = np.histogram(kept[:, channel], bins=20, range=(0, 256))[0]
        assert histogram[channel] == pytest.approx(np.cumsum(counts) / len(kept), abs=1e-6)


def test_a_region_too_far_outside_the_image_is_unseen():
    bounds = np.array([[-6, 0, 4, 10], [-5, 0, 5, 10], [-4, 0, 6, 10]], np.int32)
    unseen = np.isnan(normalised_moments(SUMS.over(bounds), 0.5)).all(axis=(1, 2))
    assert unseen.tolist() == [True, False, False]
    histograms = cumulative_histograms(PICTURE, bounds, np.zeros_like(bounds), 20, 0.5)
    assert np.isnan(histograms).all(axis=(1, 2)).tolist() == [True, False, False]


def test_a_picture_too_large_for_exact_sums_is_refused():
    huge = np.broadcast_to(np.zeros((1, 1, 1), np.uint8), (4096, 4096, 1))
    with pytest.raises(BadInput, match="at most"):
        PowerSums.build(huge, 3)
