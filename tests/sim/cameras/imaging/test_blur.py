import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.sim.cameras.imaging.blur import optics_blur, optics_blur_sheet, optics_margin, rotation_blur
from peopleboy.sim.geometry.pinhole import Pinhole

CAMERA = Pinhole(width=64, height=16, vertical_fov_rad=0.25)


def test_optics_blur_keeps_the_sum_and_has_the_stated_width() -> None:
    image = np.zeros((41, 41), np.float32)
    image[20, 20] = 1.0
    blurred = optics_blur(image, 1.5)
    assert blurred.sum() == pytest.approx(1.0, abs=1e-4)
    offset = np.arange(41) - 20
    assert (blurred.sum(0) * offset**2).sum() == pytest.approx(1.5**2, rel=0.02)


@given(turned=st.floats(-0.3, 0.3), seed=st.integers(0, 99))
@settings(deadline=None, max_examples=40)
def test_rotation_blur_stays_between_the_values_of_the_row(turned: float, seed: int) -> None:
    image = np.random.default_rng(seed).random((16, 64)).astype(np.float32)
    blurred = rotation_blur(image, CAMERA, turned)
    assert np.all(blurred >= image.min(1, keepdims=True) - 1e-5)
    assert np.all(blurred <= image.max(1, keepdims=True) + 1e-5)
    assert np.array_equal(blurred, rotation_blur(image, CAMERA, -turned))


def test_rotation_blur_equals_the_mean_over_small_turns() -> None:
    columns = np.arange(64.0)
    turned = 6.0 / CAMERA.focal_px

    def wave(u: np.ndarray) -> np.ndarray:
        return np.sin(u / 6.0)

    x = (columns - CAMERA.centre_px[0]) / CAMERA.focal_px
    angles = np.arctan(x)[None] + np.linspace(-turned / 2, turned / 2, 201)[:, None]
    expected = wave(np.tan(angles) * CAMERA.focal_px + CAMERA.centre_px[0]).mean(0)
    blurred = rotation_blur(np.tile(wave(columns), (16, 1)).astype(np.float32), CAMERA, turned)
    assert np.abs(blurred[8] - expected)[8:-8].max() < 0.01


def test_no_turn_leaves_the_image_alone() -> None:
    image = np.random.default_rng(0).random((16, 64, 3)).astype(np.float32)
    assert np.array_equal(rotation_blur(image, CAMERA, 0.0), image)


@pytest.mark.parametrize("sigma_px", [0.0, 0.3, 0.7, 2.5])
def test_many_images_are_blurred_at_once_to_the_byte_as_each_by_itself(sigma_px: float) -> None:
    images = np.random.default_rng(0).uniform(30.0, 70.0, (3, 24, 33)).astype(np.float32)
    margin = optics_margin(sigma_px)
    sheet = optics_blur_sheet(np.pad(images, ((0, 0), (margin, margin), (0, 0)), mode="edge"), sigma_px)
    for image, own in zip(images, sheet[:, margin : margin + 24], strict=True):
        assert own.tobytes() == optics_blur(image, sigma_px).tobytes()
