"""The green hat in a webcam's image (2003 paper, section 4)."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

HUES: Final = (45, 75)  # of green, in OpenCV's half degrees
LEAST_SATURATION: Final = 110
LEAST_VALUE: Final = 40
LEAST_PX: Final = 12


def hat_column(image: NDArray[np.uint8]) -> float | None:
    """Find the middle column [px] of the hat in an (H, W, 3) sRGB image; None if it is not seen whole."""
    hsv = cv2.cvtColor(image, cv2.COLOR_RGB2HSV)
    low = np.array([HUES[0], LEAST_SATURATION, LEAST_VALUE])
    mask = cv2.inRange(hsv, low, np.array([HUES[1], 255, 255]))
    count, _, stats, centres = cv2.connectedComponentsWithStats(mask)
    if count < 2:
        return None
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    left, _, width, _, area = stats[largest].tolist()
    if area < LEAST_PX or left == 0 or left + width == image.shape[1]:
        return None
    return float(centres[largest, 0])
