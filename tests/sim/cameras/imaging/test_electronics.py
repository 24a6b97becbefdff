from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.imaging.blur import optics_blur
from peopleboy.sim.cameras.imaging.electronics import (
    BIN_K,
    MOST_K,
    Gain,
    apply,
    compress,
    encode_8bit,
    equalised,
    grey_curve,
    histogram,
    sharpen,
    show_scene,
    span_of,
)

AT_ONCE = ThermalConfig(gain="percentile", gain_follows_s=0.0, least_span_k=0.5)
PLATEAU = replace(AT_ONCE, gain="plateau")
AUTOMATIC = pytest.mark.parametrize("config", [AT_ONCE, PLATEAU], ids=lambda one: one.gain)


def room(seed: int = 0, shift_c: float = 0.0) -> np.ndarray:
    """A noisy wall, a floor, two warm people and a lamp, as (120, 160) [degC]."""
    rng = np.random.default_rng(seed)
    image = np.full((120, 160), 21.0) + rng.normal(0.0, 0.08, (120, 160))
    image[80:] -= 2.0
    image[30:110, 40:60] += 9.0
    image[50:100, 100:108] += 7.0
    image[5:8, 20:60] += 35.0
    return np.float32(image + shift_c)


def clipped(grey: np.ndarray) -> float:
    return float(((grey == 0) | (grey == 255)).mean())


def grey_of(config: ThermalConfig, image: np.ndarray) -> np.ndarray:
    return Gain(config).grey(image, 0.0)


def test_the_fixed_gain_is_the_line_of_the_source() -> None:
    image = room()
    assert np.array_equal(grey_of(ThermalConfig(), image), encode_8bit(image))
    other = ThermalConfig(lowest_c=18.0, highest_c=40.0)
    assert np.array_equal(grey_of(other, image), encode_8bit(image, 18.0, 40.0))


@given(st.lists(st.floats(-50.0, 150.0), min_size=20, max_size=400), st.floats(0.0, 0.1))
@settings(deadline=None, max_examples=60)
def test_no_more_than_its_tail_lies_outside_the_span_at_either_end(values: list[float], tail: float) -> None:
    image = np.array(values, np.float32)
    low, high = span_of(histogram(image), tail)
    assert (image < low - 1e-4).mean() <= tail + 1e-9
    assert (image > high + 1e-4).mean() <= tail + 1e-9
    # A span that was a bin shorter would cut more off.
    assert (image < low + BIN_K + 1e-4).mean() > tail - 1e-9
    assert (image > high - BIN_K - 1e-4).mean() > tail - 1e-9


def test_the_percentile_gain_is_linear_between_the_percentiles() -> None:
    image = np.linspace(10.0, 30.0, 20_001, dtype=np.float32).reshape(1, -1)
    grey = grey_of(replace(AT_ONCE, tail_percent=0.4), image)
    low, high = np.percentile(image, [0.4, 99.6])
    exact = np.clip(1.0 + 253.0 * (image - low) / (high - low), 0.0, 255.0)
    assert np.abs(grey - exact).max() < 0.51 + 253.0 * BIN_K / (high - low)


def test_full_equalisation_spends_as_many_greys_on_each_as_many_pixels() -> None:
    rng = np.random.default_rng(0)
    image = np.float32(20.0 + rng.gamma(2.0, 2.0, (240, 320)))
    config = replace(PLATEAU, tail_percent=0.0, plateau_percent=100.0, linear_share=0.0)
    shares = np.histogram(grey_of(config, image), bins=11, range=(1.0, 254.5))[0] / image.size
    assert shares == pytest.approx(np.full(11, 1 / 11), abs=0.012)


def test_with_a_linear_share_of_one_equalisation_is_the_linear_gain() -> None:
    image = room()
    two = [grey_of(replace(config, linear_share=1.0), image).astype(int) for config in (AT_ONCE, PLATEAU)]
    assert np.abs(two[0] - two[1]).max() <= 1


@given(st.floats(0.0001, 1.0), st.floats(0.0, 1.0), st.floats(0.5, 60.0))
@settings(deadline=None, max_examples=40)
def test_what_is_warmer_is_never_darker_and_no_grey_rises_too_steeply(
    plateau: float, linear_share: float, least_k: float
) -> None:
    shares = histogram(room())
    rise = equalised(shares, *span_of(shares, 0.003), plateau, linear_share, least_k)
    assert rise.min() >= 0.0
    assert rise.max() <= BIN_K / least_k + 1e-12
    assert rise.sum() <= 1.0 + 1e-9
    curve = grey_curve(rise)
    assert curve[0] >= 1.0 - 1e-9
    assert curve[-1] <= 254.0 + 1e-9
    assert curve[0] - 1.0 == pytest.approx(254.0 - curve[-1])
    ramp = np.linspace(-70.0, 200.0, 5000, dtype=np.float32)
    assert np.all(np.diff(apply(ramp, curve).astype(int)) >= 0)


def test_no_part_of_the_scene_counts_for_more_than_the_plateau() -> None:
    wall, person = np.zeros(4800), slice(1700, 1800)
    wall[1600] = 0.9
    wall[person] = 0.001
    low_c, high_c = span_of(wall, 0.0)
    rise = equalised(wall, low_c, high_c, 0.004, 0.0, 0.01)
    assert rise[1600] == pytest.approx(0.004 / 0.104)
    assert rise[person].sum() == pytest.approx(0.1 / 0.104)


@AUTOMATIC
def test_one_temperature_is_a_middle_grey(config: ThermalConfig) -> None:
    grey = grey_of(config, np.full((10, 10), 21.02, np.float32))
    assert np.abs(grey.astype(int) - 127).max() <= 13


@AUTOMATIC
@pytest.mark.parametrize("image", [room(), room(shift_c=-30.0), room(shift_c=70.0)])
def test_less_than_one_percent_is_clipped(config: ThermalConfig, image: np.ndarray) -> None:
    assert clipped(grey_of(config, image)) < 0.01
    assert clipped(show_scene(image)) == 0.0


@AUTOMATIC
def test_nor_is_more_after_a_turn_towards_what_is_hotter_or_colder(config: ThermalConfig) -> None:
    for shift_c in (15.0, -15.0):
        gain = Gain(replace(config, gain_follows_s=2.0))
        gain.grey(room(), 0.0)
        turned = gain.grey(room(1, shift_c), 1 / 15)
        assert clipped(turned) < 0.01
        assert turned.std() > 5.0


def test_the_span_shrinks_with_the_time_constant() -> None:
    gain = Gain(replace(AT_ONCE, gain_follows_s=2.0))
    wide, narrow = (
        np.linspace(*ends, 10_000, dtype=np.float32)[None] for ends in ((0.0, 40.0), (10.0, 30.0))
    )
    gain.grey(wide, 0.0)
    grey = gain.grey(narrow, 1.5)
    left = 10.0 * math.exp(-1.5 / 2.0)  # beyond the narrow span at either end
    share = 20.0 / (20.0 + 2.0 * left)
    assert np.ptp(grey) / 253.0 == pytest.approx(share, abs=0.02)
    assert np.ptp(gain.grey(narrow, 60.0)) > 250


def test_a_narrow_scene_gets_no_more_than_its_part_of_the_greys() -> None:
    narrow = np.linspace(20.0, 21.0, 10_000, dtype=np.float32)[None]
    for config in (AT_ONCE, PLATEAU):
        grey = grey_of(replace(config, least_span_k=10.0), narrow)
        assert np.ptp(grey) == pytest.approx(25.3, abs=1.6)
        assert grey.mean() == pytest.approx(127.5, abs=2.0)


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ({"gain": "plato"}, "gain"),
        ({"lowest_c": 36.0}, "highest_c"),
        ({"shutter_every_s": 0.3}, "shutter_every_s"),
    ],
)
def test_what_no_camera_does_is_refused(keys: dict[str, object], key: str) -> None:
    with pytest.raises(BadInput) as caught:
        ThermalConfig(**keys)  # type: ignore[arg-type]
    assert caught.value.key == (key,)


def edge(step_k: float) -> np.ndarray:
    image = np.full((40, 60), 20.0, np.float32)
    image[:, 30:] += step_k
    return image


def test_sharpening_leaves_flat_areas_and_puts_halos_at_edges() -> None:
    sharp = sharpen(edge(1.0), 0.8, 1.5)
    assert sharp[:, :20] == pytest.approx(20.0)
    assert sharp[:, 40:] == pytest.approx(21.0)
    # Before a step, the blurred image is ahead by the Gaussian's share beyond half a pixel.
    share = 1.0 - 0.5 * (1.0 + np.tanh(np.sqrt(2.0 / np.pi) * (0.5 / 1.5)))
    assert 20.0 - sharp[20, 29] == pytest.approx(0.8 * share, rel=0.1)
    assert sharp[20, 30] - 21.0 == pytest.approx(0.8 * share, rel=0.1)


def test_a_lamp_does_not_blacken_all_around_it() -> None:
    change = sharpen(edge(60.0), 1.0, 1.5) - edge(60.0)
    assert np.abs(change).max() == pytest.approx(MOST_K)


def test_coring_evens_out_what_is_less_and_leaves_what_is_more() -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.03, (40, 60)).astype(np.float32)
    image = edge(8.0) + noise
    cored = sharpen(image, 0.0, 1.5, coring_k=0.12)
    assert cored[:, :20].std() < 0.4 * image[:, :20].std()
    assert cored[:, 29:31] == pytest.approx(image[:, 29:31])


def test_coring_without_end_is_the_blurred_image_and_none_is_the_unsharp_mask() -> None:
    image = edge(1.0)
    assert sharpen(image, 0.8, 1.5, coring_k=50.0) == pytest.approx(optics_blur(image, 1.5), abs=1e-5)
    assert sharpen(image, 0.8, 1.5, coring_k=1e-6) == pytest.approx(sharpen(image, 0.8, 1.5), abs=1e-5)


def test_no_sharpening_is_the_same_image() -> None:
    image = edge(3.0)
    assert sharpen(image, 0.0, 1.5) is image


def test_compression_is_that_of_a_file_of_the_quality() -> None:
    grey = np.random.default_rng(0).integers(90, 160, (64, 80)).astype(np.uint8)
    errors, sizes = [], []
    for quality in (20, 60, 95):
        packed = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        image = compress(grey, quality)
        assert np.array_equal(image, cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE))
        # An image that went through JPEG packs again without more loss to speak of.
        assert np.abs(compress(image, quality).astype(int) - image).mean() < 1.5
        errors.append(np.abs(image.astype(int) - grey).mean())
        sizes.append(len(packed))
    assert sizes == sorted(sizes)
    assert errors == sorted(errors, reverse=True)
    assert compress(grey, None) is grey
