"""What must hold of pictures of any kind before they are tracked in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.tracker.boxes import Box, corners
from peopleboy.tracker.footage.grey import LEAST_SIDE_PX


def check_first(picture: NDArray[Any], options: TrackOptions) -> None:
    """Refuse footage by its first picture (H, W) or (H, W, 3).

    Raises:
        BadInput: it is too small, or the box to start from is not inside.
    """
    height, width = picture.shape[:2]
    if min(height, width) < LEAST_SIDE_PX:
        least = f"{LEAST_SIDE_PX}x{LEAST_SIDE_PX}"
        raise BadInput(f"{options.footage}: pictures must be at least {least}, got {width}x{height}")
    if options.start is not None and not isinstance(options.start, str):
        _check_inside(options.start, width, height)


def _check_inside(box: Box, width: int, height: int) -> None:
    left, top, right, bottom = corners(box)
    if not (left >= 0 and top >= 0 and right <= width and bottom <= height):
        told = ",".join(f"{number:g}" for number in box)
        raise BadInput(f"--start {told}: X,Y,W,H must lie inside the pictures, which are {width}x{height}")


def colour_picture(picture: NDArray[Any], where: str) -> NDArray[np.uint8]:
    """Give a picture (H, W) or (H, W, 3) in colours, (H, W, 3).

    Raises:
        BadInput: it is not of 8 bits; `where` says which pictures those are.
    """
    if picture.dtype != np.uint8:
        raise BadInput(f"{where}: pictures must be 8-bit, got {picture.dtype}")
    return np.repeat(picture[..., None], 3, axis=2) if picture.ndim == 2 else np.ascontiguousarray(picture)
