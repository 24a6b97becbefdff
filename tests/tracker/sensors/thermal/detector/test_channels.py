import math

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.channels import (
    BESIDE,
    CHANNELS,
    DIRECTIONS,
    FIRST_DIRECTION,
    GRADIENT,
    GREY,
    MOTION,
    OVER,
    channels,
    noise_of,
)

Floats = NDArray[np.float64]
ROWS, COLUMNS = 60, 80


def ramp(direction_rad: float, steepness: float = 4.0) -> NDArray[np.float32]:
    v, u = np.mgrid[:ROWS, :COLUMNS]
    return (steepness * (u * math.cos(direction_rad) + v * math.sin(direction_rad))).astype(np.float32)


def speckled(seed: int = 0, rows: int = ROWS) -> NDArray[np.float32]:
    rng = np.random.default_rng(seed)
    rough = rng.uniform(0.0, 255.0, (rows // 4, COLUMNS // 4))
    return (np.kron(rough, np.ones((4, 4))) + rng.normal(0.0, 3.0, (rows, COLUMNS))).astype(np.float32)


def still(rows: int = ROWS) -> NDArray[np.float32]:
    return np.zeros((rows // 2, COLUMNS // 2), np.float32)


def smoothed(image: Floats, mode: str) -> Floats:
    """By 1 2 1, both ways."""
    for axis in (0, 1):
        wide = np.pad(image, [(int(axis == 0),) * 2, (int(axis == 1),) * 2], mode=mode)
        count = image.shape[axis]
        a, b, c = (np.take(wide, range(k, k + count), axis) for k in range(3))
        image = (a + 2.0 * b + c) / 4.0
    return image


def boxed(image: Floats, side: int) -> Floats:
    """Mean of those around, mirrored at the border."""
    wide = np.pad(image, side // 2, mode="reflect")
    return np.lib.stride_tricks.sliding_window_view(wide, (side, side)).mean(axis=(2, 3))


def pooled(image: Floats) -> Floats:
    return image.reshape(image.shape[0] // 2, 2, image.shape[1] // 2, 2).mean(axis=(1, 3))


def computed_otherwise(grey: Floats, change: Floats, noise: float) -> Floats:
    """By the angles of gradients, without a loop over pixels."""
    image = smoothed(grey, "reflect")
    high = np.pad(image, ((1, 1), (0, 0)), mode="edge")
    right, down = np.zeros_like(image), (high[2:] - high[:-2]) / 2.0
    right[:, 1:-1] = (image[:, 2:] - image[:, :-2]) / 2.0
    down[:, [0, -1]] = 0.0
    size, angle = np.hypot(right, down), np.arctan2(down, right)
    least = 1.0 + 1.5 * noise
    cells, around = pooled(image), boxed(pooled(size), 5) + least
    mean = boxed(cells, 21)
    spread = np.sqrt(np.maximum(boxed(pooled(image**2), 21) - mean**2, 0.0)) + 2.0 * least
    out = [(cells - mean) / spread, pooled(size) / around]
    for k in range(DIRECTIONS):
        apart = angle - math.pi * (k + 0.5) / DIRECTIONS
        out.append(pooled(size * np.maximum(2.0 * np.cos(2.0 * apart) - 1.0, 0.0)) / around)
    out.append(np.minimum(change / spread, 3.0))
    return np.stack(
        [np.pad(smoothed(one, "edge"), ((OVER, OVER), (BESIDE, BESIDE)), mode="edge") for one in out]
    )


def test_the_kernel_agrees_with_a_second_computation() -> None:
    change = np.abs(speckled(1))[::2, ::2].copy()
    expected = computed_otherwise(speckled().astype(np.float64), change.astype(np.float64), 2.0)
    np.testing.assert_allclose(channels(speckled(), change, 2.0), expected, atol=2e-3)


@pytest.mark.parametrize("k", range(DIRECTIONS))
def test_a_ramp_has_its_gradient_in_its_own_direction_alone(k: int) -> None:
    cells = channels(ramp(math.pi * (k + 0.5) / DIRECTIONS), still(), 0.0)[:, OVER + 13, 22]
    expected = np.zeros(CHANNELS)
    expected[[GRADIENT, FIRST_DIRECTION + k]] = 4.0 / (4.0 + 1.0)  # over the mean around, and one grey
    np.testing.assert_allclose(np.delete(cells, GREY), np.delete(expected, GREY), atol=1e-4)
    assert abs(cells[GREY]) < 1e-3  # it is the mean of what is around it


def test_a_plain_image_has_nothing() -> None:
    assert np.abs(channels(np.full((ROWS, COLUMNS), 77.0, np.float32), still(), 1.0)).max() < 1e-3


def test_a_mirrored_image_has_mirrored_channels_with_directions_swapped() -> None:
    image, change = speckled(), np.abs(speckled(1))[::2, ::2].copy()
    cells = channels(image, change, 1.0)
    mirrored = channels(np.ascontiguousarray(image[:, ::-1]), np.ascontiguousarray(change[:, ::-1]), 1.0)
    order = [GREY, GRADIENT, *reversed(range(FIRST_DIRECTION, MOTION)), MOTION]
    np.testing.assert_allclose(mirrored[:, :, ::-1], cells[order], atol=1e-4)


@pytest.mark.parametrize(("gain", "offset"), [(1.0, 40.0), (0.6, 10.0), (2.0, -100.0)])
def test_gain_and_offset_of_the_image_change_little(gain: float, offset: float) -> None:
    change = np.abs(speckled(1))[::2, ::2].copy()
    cells, others = (channels(g * speckled() + o, g * change, 0.0) for g, o in ((1.0, 0.0), (gain, offset)))
    assert np.abs(others - cells).max() < 0.12
    assert np.abs(others - cells).mean() < 0.02


def test_the_border_goes_on_as_it_ends() -> None:
    cells = channels(speckled(), still(), 1.0)
    assert cells.shape == (CHANNELS, ROWS // 2 + 2 * OVER, COLUMNS // 2 + 2 * BESIDE)
    np.testing.assert_array_equal(cells[:, :, 0], cells[:, :, BESIDE])
    np.testing.assert_array_equal(cells[:, -1], cells[:, -1 - OVER])


def test_rows_far_enough_from_a_cut_are_those_of_the_whole_image() -> None:
    image = speckled(rows=120)
    whole, part = channels(image, still(120), 1.0), channels(image[20:], still(100), 1.0)
    np.testing.assert_allclose(part[:, OVER + 12 : -OVER], whole[:, OVER + 22 : -OVER], atol=1e-4)


def test_noise_is_told_whatever_slopes_the_image_has() -> None:
    rng = np.random.default_rng(5)
    noisy = ramp(0.3) + rng.normal(0.0, 2.5, (ROWS, COLUMNS)).astype(np.float32)
    assert noise_of(noisy) == pytest.approx(2.5, rel=0.2)
    assert noise_of(ramp(0.3)) == pytest.approx(0.0, abs=1e-4)
