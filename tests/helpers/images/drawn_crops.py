"""Crops of bars, and networks that know nothing."""

from __future__ import annotations

import jax
import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.detector.crop_samples import (
    CropSamples,
    CropTraining,
    first_weights,
    network_outputs,
)
from peopleboy.tracker.networks.inference import Architecture
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS
from peopleboy.tracker.sensors.thermal.detector.crops import CHANNELS, FEATURES, Planes


def drawn_crops(architecture: Architecture, count: int, seed: int = 0, targets: int = OFFSETS) -> CropSamples:
    """Draw crops of which those of people have a bright upright bar in the middle, the others a lying one.

    The bar of somebody who is to the right of the crop's middle is, too.
    """
    rng = np.random.default_rng(seed)
    rows, columns, heights = architecture.crop
    crops = rng.integers(60, 120, (count, rows, columns, CHANNELS)).astype(np.uint8)
    features = rng.normal(0.0, 0.1, (count, FEATURES)).astype(np.float32)
    usual = [0.0, 0.0, 0.0, 0.22, -0.18, 0.18][:targets]
    offsets = rng.normal(usual, 0.02, (count, targets)).astype(np.float32)
    is_person = rng.random(count) < 0.5
    pixels_per_height = rows / heights
    for crop, someone, aside in zip(crops, is_person, offsets[:, 0] * pixels_per_height, strict=True):
        middle = round(columns / 2.0 + float(aside))
        if someone:
            crop[rows // 6 : -(rows // 6), middle - columns // 12 : middle + columns // 12, 0] = 220
        else:
            crop[rows // 2 - 4 : rows // 2 + 4, columns // 12 : -(columns // 12), 0] = 220
    crops[..., 2] = 255
    return CropSamples(crops, features, np.where(is_person, 0.8, 0.0).astype(np.float32), offsets)


def loss_of(
    training: CropTraining, weights: dict[str, NDArray[np.float32]], planes: Planes, samples: CropSamples
) -> tuple[jax.Array, dict[str, jax.Array]]:
    """Return what is minimised for samples with normalised crops, and results."""
    architecture = training.NETWORK.ARCHITECTURE
    return training.loss(network_outputs(architecture, weights, planes, samples.features), samples)


def drawn_weights(
    architecture: Architecture, last: float = 5.0, seed: int = 3
) -> dict[str, NDArray[np.float32]]:
    """Draw weights, those of the last layer so many times as large as they are at first."""
    weights = first_weights(architecture, np.random.default_rng(seed))
    weights["last"] *= np.float32(last)
    return weights
