"""Augmentation by a camera's electronics and file format: gain control, edge sharpening, compression."""

from dataclasses import replace
from typing import Final

import cv2
import numpy as np

from peopleboy.sim.cameras.imaging.electronics import compress
from peopleboy.studies.training.detector.augmentation import Draw, Grey
from peopleboy.studies.training.detector.world_sequences import ThermalImage

_EQUALISED: Final = 0.25
_MOST_EQUALISED: Final = 0.8  # share of full histogram equalisation
_SHARPENED: Final = 0.3
_RADII_PX: Final = (0.8, 3.0)
_MOST_SHARPENED: Final = 1.5
_COMPRESSED: Final = 0.4
_QUALITIES: Final = (25, 92)


def simulate_electronics(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Simulate, with some probability, a camera that processes its images for display."""
    if rng.random() < _EQUALISED:
        image = equalise(image, rng.uniform(0.0, _MOST_EQUALISED))
    if rng.random() < _SHARPENED:
        radius_px, gain = rng.uniform(*_RADII_PX), rng.uniform(0.0, _MOST_SHARPENED)
        image = replace(image, grey=sharpen(image.grey, radius_px, gain))
    if rng.random() < _COMPRESSED:
        image = replace(image, grey=compress(image.grey, int(rng.integers(*_QUALITIES))))
    return image


def equalise(image: ThermalImage, share: float) -> ThermalImage:
    """Equalise the histogram partly, like an automatic gain control with plateau equalisation.

    The image of changes is multiplied by the slope of the grey curve.
    """
    counts = np.bincount(image.grey.ravel(), minlength=256)
    rank = 255.0 * np.cumsum(counts) / counts.sum()
    curve = (1.0 - share) * np.arange(256.0) + share * rank
    slope = cv2.GaussianBlur(np.gradient(curve)[None], (0, 0), 4.0)[0]
    change = np.clip(image.change * slope[image.grey], 0.0, 255.0)
    return replace(
        image, grey=np.rint(curve).astype(np.uint8)[image.grey], change=np.rint(change).astype(np.uint8)
    )


def sharpen(grey: Grey, radius_px: float, gain: float) -> Grey:
    """Sharpen details finer than a radius, which leaves rims around warm objects.

    The simulated camera sharpens in kelvin, before greys are encoded; here only the greys are available.
    """
    values = grey.astype(np.float32)
    finer = values - cv2.GaussianBlur(values, (0, 0), radius_px)
    return np.asarray(np.rint(np.clip(values + gain * finer, 0.0, 255.0)), np.uint8)
