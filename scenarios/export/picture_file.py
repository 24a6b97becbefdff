"""Lossless image files."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from bad_input import BadInput


def write_png(path: Path, image: NDArray[np.uint8] | NDArray[np.uint16]) -> None:
    """Write an (H, W) grey image of 8 or 16 bits, or an (H, W, 3) RGB one.

    Raises:
        BadInput: it cannot be written.
    """
    stored = image[..., ::-1] if image.ndim == 3 else image
    if not cv2.imwrite(str(path), stored, [cv2.IMWRITE_PNG_COMPRESSION, 2]):
        raise BadInput(f"{path}: cannot write this image; is the disk full?")
