"""How much grey differs from place to place in an image for no other reason than that it is of somewhere."""

from __future__ import annotations

import math
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import REFERENCE_HEIGHT_PX

SETTLES_S: Final = 0.5  # time constant with which a tracker takes in that the clutter changes
_APART_PX: Final = 8  # of 240 rows: between the two pixels of a pair
_SHARE: Final = 0.75  # of the pairs differ by less: people, lamps and windows are among the others
_STRIDE: Final = 4


def clutter_of(image: NDArray[np.uint8]) -> float:
    """Measure by how much [grey] most pixels of an image (H, W) differ at most from those nearby.

    Raised by noise, texture and sharp gain; people, lamps and windows take too little of an image to count.
    """
    apart = max(round(_APART_PX * image.shape[0] / REFERENCE_HEIGHT_PX), 1)
    rows, columns = image[::_STRIDE], image[:, ::_STRIDE]
    counts = np.zeros(256)
    for one, other in ((rows[:, apart:], rows[:, :-apart]), (columns[apart:], columns[:-apart])):
        if one.size:
            counts += np.bincount(cv2.absdiff(one, other).reshape(-1), minlength=256)
    return float(np.searchsorted(np.cumsum(counts), _SHARE * counts.sum()))


def settled(before: float | None, now: float, dt_s: float) -> float:
    """Let the clutter [grey] follow what is measured now, slowly, so that no person's evidence pumps."""
    return now if before is None else before + (1 - math.exp(-dt_s / SETTLES_S)) * (now - before)
