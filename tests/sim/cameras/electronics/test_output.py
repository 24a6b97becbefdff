from __future__ import annotations

import cv2
import numpy as np
import pytest

from peopleboy.sim.cameras.blur import optics_blur
from peopleboy.sim.cameras.electronics.gain import MOST_K, compress, sharpen


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
