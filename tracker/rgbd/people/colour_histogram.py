"""What somebody looks like: a histogram of hue and saturation (SA 4.6)."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats

HUES: Final = 12
SATURATIONS: Final = 6
GREYS: Final = 4
BINS: Final = HUES * SATURATIONS + GREYS

_LEAST_SATURATION: Final = 26
_DARKEST: Final = 40
_BRIGHTEST: Final = 250
_BITS: Final = 5  # of each colour that decide about the bin


@lru_cache(maxsize=1)
def bin_of_colour() -> NDArray[np.uint8]:
    """Tabulate the bin of each colour (32768,) of five bits a channel.

    The source drops colours with too little or too much of hue or saturation; here they have bins by
    brightness, without which black clothes have no histogram at all.
    """
    step = np.arange(1 << _BITS, dtype=np.uint8) * 8 + 4
    red, green, blue = np.meshgrid(step, step, step, indexing="ij")
    colours = np.stack([red, green, blue], axis=-1).reshape(1, -1, 3)
    hue, saturation, value = (
        channel.astype(np.int64) for channel in cv2.split(cv2.cvtColor(colours, cv2.COLOR_RGB2HSV))
    )
    coloured = hue * HUES // 180 * SATURATIONS + saturation * SATURATIONS // 256
    grey = HUES * SATURATIONS + value * GREYS // 256
    is_grey = (saturation < _LEAST_SATURATION) | (value < _DARKEST) | (value > _BRIGHTEST)
    return np.where(is_grey, grey, coloured).astype(np.uint8).ravel()


def similarity(one: Floats, other: Floats) -> float:
    """Give the Bhattacharyya coefficient of two histograms, 1 for equal ones (SA eq. 4.25).

    The source prints a comma between the two; their product is meant.
    """
    return float(np.sqrt(one * other).sum())


@njit(cache=True, nogil=True)
def bin_at(image: NDArray[np.uint8], v: int, u: int, table: NDArray[np.uint8]) -> int:
    """Look up the bin of a pixel."""
    red, green, blue = image[v, u, 0] >> 3, image[v, u, 1] >> 3, image[v, u, 2] >> 3
    return int(table[(red << 10) | (green << 5) | blue])
