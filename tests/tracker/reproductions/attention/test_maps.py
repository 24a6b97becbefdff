"""The 24 maps: closed forms on plain images, and a second computation of each sum."""

import cv2
import numpy as np
import pytest

from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.reproductions.attention.box_scores import (
    box_means,
    likenesses,
    mean_scores,
    pattern_scores,
    spreads,
)
from peopleboy.tracker.reproductions.attention.feature_maps import (
    BASIC_NAMES,
    NAMES,
    SURROUND,
    _by_peaks,
    _inhibited,
    basic_maps,
    feature_maps,
)
from peopleboy.tracker.reproductions.attention.image_sums import BINS, ImageSums, patterns
from tests.helpers.calls.refused import refused

RNG = np.random.default_rng(5)


def plain(red, green, blue):
    return np.tile(np.array([red, green, blue], np.uint8), (48, 64, 1))


@pytest.mark.parametrize(
    ("rgb", "name", "value"),
    [
        ((240, 0, 0), "red", 3),
        ((120, 120, 0), "yellow", 1.5),
        ((0, 90, 0), "green", 3),
        ((0, 0, 90), "blue", 3),
    ],
)
def test_a_pure_colour_is_in_its_own_map_alone(rgb, name, value):
    maps = basic_maps(plain(*rgb), inhibits=False)[24, 32, :4]
    others = [k for k in range(4) if BASIC_NAMES[k] != name and name != "yellow"]
    assert maps[BASIC_NAMES.index(name)] == pytest.approx(value, rel=0.01)
    assert np.allclose(maps[others], 0.0)


def test_grey_has_no_colour_and_is_as_dark_as_it_is_not_bright():
    maps = basic_maps(plain(60, 60, 60), inhibits=False)[24, 32]
    assert np.allclose(maps[:4], 0.0, atol=1e-6)
    assert maps[8] + maps[9] == pytest.approx(1.0)


@pytest.mark.parametrize("turn", [0, 45, 90, 135])
def test_lines_are_strongest_in_the_map_of_their_direction(turn):
    v, u = np.mgrid[:60, :80]
    along = np.deg2rad(turn)
    across = -u * np.sin(along) - v * np.cos(along)  # rows count downwards
    grey = (127.5 + 100.0 * np.cos(2.0 * np.pi * across / 6.0)).astype(np.uint8)
    maps = basic_maps(np.dstack([grey] * 3), inhibits=False)[20:40, 20:60].mean(axis=(0, 1))
    assert BASIC_NAMES[4 + int(maps[4:8].argmax())] == f"{turn} deg"


def test_lateral_inhibition_gives_the_number_of_the_source():
    maps = np.zeros((1, 1, 10), np.float32)
    maps[0, 0, :4] = (123.0, 15.0, 200.0, 81.0)
    assert _inhibited(maps)[0, 0, 0] == 123.0 + 2.0 * 123.0 - (15.0 + 81.0) == 273.0
    assert _inhibited(maps).min() >= 0.0


def test_nothing_of_an_even_area_is_left_by_centre_surround():
    assert np.allclose(feature_maps(plain(200, 30, 90), PRINTED)[..., SURROUND], 0.0, atol=1e-4)


def test_what_differs_from_its_surroundings_is_in_the_map_of_its_colour_alone():
    image = plain(120, 120, 120)
    image[18:28, 26:36] = (200, 40, 40)
    maps = feature_maps(image, AttentionConfig(surround=True))[..., SURROUND]
    assert maps[11, 15, 0] > 5.0 * maps[11, 15, 2]


def test_a_map_with_four_peaks_counts_half():
    maps = np.zeros((40, 60, 2), np.float32)
    maps[10:12, 10:12, 0] = 1.0
    for v, u in ((8, 8), (8, 40), (28, 8), (28, 40)):
        maps[v : v + 2, u : u + 2, 1] = 1.0
    found = _by_peaks(maps)
    assert np.allclose(found[..., 0], maps[..., 0])
    assert np.allclose(found[..., 1], maps[..., 1] / 2.0)


def test_patterns_are_uniform_or_in_the_last_bin():
    image = RNG.integers(0, 256, (20, 30, 3), dtype=np.uint8)
    grey = image.astype(int).sum(axis=2)
    found = patterns(image)
    ring = [(-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1)]
    for v, u in RNG.integers(1, 19, (40, 2)):
        bits = [grey[v + dv, u + du] >= grey[v, u] for dv, du in ring]
        changes = sum(bits[k] != bits[k - 1] for k in range(8))
        assert (found[v, u] == BINS - 1) == (changes > 2)
    assert len(np.unique(patterns(plain(9, 9, 9)))) == 1


@pytest.fixture(scope="module")
def sight():
    image = cv2.GaussianBlur(RNG.integers(0, 256, (60, 80, 3), dtype=np.uint8), (0, 0), 2.0)
    return ImageSums.of(image, AttentionConfig(surround=True))


def test_means_and_spreads_of_boxes_are_those_of_their_cells(sight):
    box = sight.maps[4:11, 20:29].astype(np.float64)
    assert np.allclose(box_means(sight.map_sums, 4, 20, 7, 9), box.mean(axis=(0, 1)), atol=1e-5)
    means = [
        sight.maps[row : row + 7, column : column + 9].mean(axis=(0, 1), dtype=np.float64)
        for row in range(0, 30 - 7 + 1, 2)
        for column in range(0, 40 - 9 + 1, 2)
    ]
    assert np.allclose(spreads(sight.map_sums, 7, 9, 2), np.std(means, axis=0), atol=1e-5)


def test_scores_of_places_are_those_of_each_box_by_itself_and_0_outside(sight):
    rows, columns, size = np.array([-1, 4, 29]), np.array([20, 33]), (7, 8)
    learned, spread = np.full(len(NAMES), 0.1), np.full(len(NAMES), 0.5)
    used = np.arange(len(NAMES)) % 3 > 0
    found = likenesses(sight.map_sums, rows, columns, size, learned, spread, used)
    box = sight.maps[4:11, 20:28].mean(axis=(0, 1), dtype=np.float64)[used]
    assert found[1, 0] == pytest.approx(np.exp(-np.minimum(((box - 0.1) / 0.5) ** 2, 9.0).mean()), abs=1e-5)
    assert np.count_nonzero(found) == 1
    one = cv2.integral(sight.maps[..., 3], sdepth=cv2.CV_64F)
    assert mean_scores(one, rows, columns, size)[1, 0] == pytest.approx(
        sight.maps[4:11, 20:28, 3].mean(), abs=1e-5
    )


def test_patterns_of_a_box_are_compared_bin_by_bin(sight):
    bins = patterns(sight.image)[8:22, 40:56]
    share = np.bincount(bins.ravel(), minlength=BINS) / bins.size
    learned, weight = np.full(BINS, 1 / BINS, np.float32), np.full(BINS, 2.0, np.float32)
    at = np.array([4]), np.array([20])
    found = pattern_scores(sight.pattern_sums, *at, (7, 8), learned, weight)
    assert found[0, 0] == pytest.approx(1.0 - 2.0 * ((share - 1 / BINS) ** 2).sum(), abs=1e-5)


@pytest.mark.parametrize(
    "image", [np.zeros((48, 64), np.uint8), np.zeros((48, 64, 3)), np.zeros((4, 64, 3), np.uint8), None]
)
def test_what_is_no_colour_image_is_refused(image):
    with refused("attention: image must be (H, W, 3) uint8"):
        ImageSums.of(image, AttentionConfig())


def test_settings_that_make_no_sense_are_refused():
    with refused("unknown share 'part'; choose from sums, means"):
        AttentionConfig(share="part")
    with refused("maps or colour must be used"):
        AttentionConfig(maps=False, colour=False)
    with refused("scales must be positive"):
        AttentionConfig(scales=(0.0,))
    with refused("rate must be in 0..1, got 2"):
        AttentionConfig(rate=2)


def test_maps_with_a_common_range_have_their_maximum_at_one_before_the_peaks():
    config = AttentionConfig(has_range=True)
    image = np.random.default_rng(3).integers(0, 255, (60, 80, 3), np.uint8)
    assert np.allclose(feature_maps(image, config)[..., :10].max(axis=(0, 1)), 1.0)
    assert not feature_maps(plain(0, 0, 0), config)[..., 0].any()
