"""Pictures for a tracker that knows contrasts alone: each place in deviations of those around it."""

from __future__ import annotations

from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.uint8]
Values = NDArray[np.float32]

AROUND: Final = 0.4
"""Deviation of the Gaussian that says what is around, in heights of the picture."""

GREYS: Final = 50.0
"""How many greys a deviation makes."""

NOISE: Final = 20.0
"""Standard deviations of the noise in the least deviation, so that a bare wall stays one."""

LEAST: Final = 0.01
"""The same, in spans of the whole picture, as pictures of few steps seem to have no noise."""

OUTLIERS: Final = 0.05
"""Share of the pixels, of lamps and heaters, which differ no more than the others do."""


def local_grey(values: Values) -> Grey:
    """Tell by how much each pixel differs from those around it, in what they differ by among each other.

    What is hardly warmer or colder than a wall stands out though a lamp in the picture is far hotter, which
    a single gain for all of it cannot give. Greys depend neither on the unit nor on the temperature.

    Args:
        values: (H, W) of any unit, 0 being no special one; warm is more.

    Returns:
        (H, W), 128 being as warm as what is around.
    """
    values = values - np.float32(np.median(values))  # so that rounding does not grow with the offset
    away = values - _around(values)
    square = np.square(away)
    square = np.minimum(square, np.float32(np.percentile(square, 100.0 * (1.0 - OUTLIERS))))
    deviation = np.maximum(np.sqrt(_around(square)), np.float32(_least_deviation(values)))
    grey = 128.0 + np.float32(GREYS) * away / deviation
    return np.asarray(np.clip(np.rint(grey), 0, 255), np.uint8)


def noise_of(values: Values) -> float:
    """Give the standard deviation of the noise of a picture (H, W), by how much rows bend."""
    bend = values[:, 2:] + values[:, :-2] - 2.0 * values[:, 1:-1]
    return float(np.median(np.abs(bend)) / 0.6745 / np.sqrt(6.0))


def _least_deviation(values: Values) -> float:
    low, high = np.percentile(values, [1, 99])
    return max(NOISE * noise_of(values), LEAST * float(high - low), 1e-6)


def _around(values: Values) -> NDArray[Any]:
    return cv2.GaussianBlur(values, (0, 0), AROUND * values.shape[0])
