"""What is done to a thermal image for people to look at: edges sharpened before the gain, JPEG after it."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.blur import optics_blur

MOST_K: Final = 2.0
"""[K] by which sharpening changes a pixel at most: a lamp would blacken all around it."""


def sharpen(temperature_c: NDArray[np.float32], amount: float, radius_px: float) -> NDArray[np.float32]:
    """Add to an (H, W) image what it has more than its blurred self, times an amount: an unsharp mask.

    At edges this leaves halos, dark on the cold side and bright on the warm one.
    """
    if amount <= 0.0 or radius_px <= 0.0:
        return temperature_c
    crisp = optics_blur(temperature_c, radius_px)
    _add_detail(temperature_c.reshape(-1), np.float32(amount), np.float32(MOST_K), crisp.reshape(-1))
    return crisp


@njit(cache=True, fastmath=True)
def _add_detail(
    values: NDArray[np.float32], amount: np.float32, most: np.float32, blurred: NDArray[np.float32]
) -> None:
    """Replace blurred values (N,) by sharpened ones."""
    for i in range(len(values)):
        detail = amount * (values[i] - blurred[i])
        blurred[i] = values[i] + min(max(detail, -most), most)


def compress(grey: NDArray[np.uint8], quality: int | None) -> NDArray[np.uint8]:
    """Pass an (H, W) image through JPEG of a quality of 1..100; None leaves it as it is."""
    if quality is None:
        return grey
    packed = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
