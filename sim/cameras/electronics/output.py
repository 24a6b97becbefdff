"""What is done to a thermal image for people to look at: details enhanced before the gain, JPEG after it."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.blur import optics_blur

MOST_K: Final = 2.0
"""[K] by which sharpening changes a pixel at most: a lamp would blacken all around it."""


def sharpen(
    temperature_c: NDArray[np.float32], amount: float, radius_px: float, coring_k: float = 0.0
) -> NDArray[np.float32]:
    """Add to an (H, W) image what it has more than its blurred self, times an amount: an unsharp mask.

    At edges this leaves halos, dark on the cold side and bright on the warm one. With coring, what differs
    by less than that is taken for noise, and for the blurred image; what differs by twice as much stays. So
    do the digital detail filters of uncooled cameras: walls are smooth, and edges are crisp.

    Args:
        temperature_c: (H, W) [degC].
        amount: of the mask.
        radius_px: [px] standard deviation of the blur.
        coring_k: [K].
    """
    if (amount <= 0.0 and coring_k <= 0.0) or radius_px <= 0.0:
        return temperature_c
    crisp = optics_blur(temperature_c, radius_px)
    values, blurred, most = temperature_c.reshape(-1), crisp.reshape(-1), np.float32(MOST_K)
    if coring_k > 0.0:
        _keep_detail(values, np.float32(amount), np.float32(coring_k), most, blurred)
    else:
        _add_detail(values, np.float32(amount), most, blurred)
    return crisp


@njit(cache=True, fastmath=True)
def _add_detail(
    values: NDArray[np.float32], amount: np.float32, most: np.float32, blurred: NDArray[np.float32]
) -> None:
    """Replace blurred values (N,) by sharpened ones."""
    for i in range(len(values)):
        detail = amount * (values[i] - blurred[i])
        blurred[i] = values[i] + min(max(detail, -most), most)


@njit(cache=True, fastmath=True)
def _keep_detail(
    values: NDArray[np.float32],
    amount: np.float32,
    coring: np.float32,
    most: np.float32,
    blurred: NDArray[np.float32],
) -> None:
    """Replace blurred values (N,) by sharpened ones, but where they differ little from them."""
    none, one = np.float32(0.0), np.float32(1.0)
    steeper = one / coring
    for i in range(len(values)):
        apart = values[i] - blurred[i]
        kept = min(max(abs(apart) * steeper - one, none), one)
        change = apart * (kept * (one + amount) - one)
        blurred[i] = values[i] + min(max(change, -most), most)


def compress(grey: NDArray[np.uint8], quality: int | None) -> NDArray[np.uint8]:
    """Pass an (H, W) image through JPEG of a quality of 1..100; None leaves it as it is."""
    if quality is None:
        return grey
    packed = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
