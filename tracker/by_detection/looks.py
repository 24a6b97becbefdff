"""How people look in the thermal image: a small pattern of warm and cold."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

Pattern = NDArray[np.float32]

ROWS: Final = 12
COLUMNS: Final = 6
SAMPLES: Final = ROWS * COLUMNS
_FAINT_GREY: Final = 4.0  # contrast below which a pattern is mostly noise


def patterns(image: NDArray[np.float32], boxes: NDArray[np.float64]) -> Pattern:
    """Describe what is in boxes (M, 4) of an image (H, W): (M, SAMPLES), mean 0 and length up to 1.

    Neither the brightness of the image nor its contrast matters.
    """
    across = (np.arange(COLUMNS) + 0.5) / COLUMNS
    down = (np.arange(ROWS) + 0.5) / ROWS
    x = boxes[:, 0, None, None] + boxes[:, 2, None, None] * across[None, None, :]
    y = boxes[:, 1, None, None] + boxes[:, 3, None, None] * down[None, :, None]
    if len(boxes) == 0:
        return np.empty((0, SAMPLES), np.float32)
    at_x, at_y = (
        np.broadcast_to(grid, (len(boxes), ROWS, COLUMNS)).reshape(-1, COLUMNS).astype(np.float32)
        for grid in (x, y)
    )
    seen = cv2.remap(image, at_x, at_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    flat = seen.reshape(len(boxes), -1)
    flat = flat - flat.mean(axis=1, keepdims=True)
    contrast = np.sqrt(np.mean(flat * flat, axis=1, keepdims=True))
    return np.asarray(flat / (contrast + _FAINT_GREY) / np.sqrt(np.float32(flat.shape[1])), np.float32)
