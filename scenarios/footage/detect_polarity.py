"""Detection of black-hot images, in which warm objects are dark.

The detector of people uses contrast of either sign, but its scores are higher for images as in its training,
which were white-hot. The images of a clip are compared with their negatives.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.footage.grey import Polarity
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector

LOOK_AHEAD: Final = 150
"""Images at the beginning of a clip, 10 s at 15 Hz, from which a few are compared."""

_COMPARED: Final = 8
_CLEARLY: Final = 1.15
"""Ratio of the sums of scores from which one is clearly higher."""
_MOST: Final = 0.75
"""Share of the images with people that must agree."""
_LEAST: Final = 1.5
"""Sum of log-odds per image from which there is evidence; faint people may be colder than a hot room."""


def detect_polarity(images: Sequence[NDArray[np.uint8]]) -> Polarity | None:
    """Return the polarity of grey images (H, W); None if it is not clear, for example without people."""
    chosen = np.unique(np.linspace(0, len(images) - 1, min(_COMPARED, len(images))).round().astype(int))
    pairs = np.array([(_evidence(images[k]), _evidence(255 - images[k])) for k in chosen])
    if pairs.sum(axis=0).max() < _LEAST * len(pairs):
        return None
    pairs = pairs[pairs.max(axis=1) > 0.0]
    for polarity, (one, other) in ((Polarity.WHITE_HOT, pairs.T), (Polarity.BLACK_HOT, pairs.T[::-1])):
        if one.sum() > _CLEARLY * other.sum() and (one > other).mean() >= _MOST:
            return polarity
    return None


def _evidence(image: NDArray[np.uint8]) -> float:
    """Return the sum of log-odds of the people in an image."""
    return float(PeopleDetector().update(image, 0.0).score.sum())
