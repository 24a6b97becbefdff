"""What surfaces look like in the pixels of a depth image: their colours, or how much light they send back."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, DEPTH_AMPLITUDE, DEPTH_COLOUR, Frame

Shades = NDArray[np.uint8]

_WHITE_AT_1_M = 10_000.0  # amplitude


def shades_of(frame: Frame) -> Shades | None:
    """Give (H, W, 3) RGB, or (H, W, 1) reflectance of a time-of-flight sensor; None where neither is there.

    Raises:
        BadInput: its size is not that of the depth image.
    """
    if DEPTH_COLOUR in frame.images:
        colour = frame.rgb(DEPTH_COLOUR)
        _check_size(colour.shape, frame)
        return colour
    if DEPTH_AMPLITUDE not in frame.images:
        return None
    amplitude = frame.depth(DEPTH_AMPLITUDE)
    _check_size(amplitude.shape, frame)
    reflectance = amplitude * (frame.depth(DEPTH).astype(np.float32) / 1000.0) ** 2 / _WHITE_AT_1_M
    return np.asarray(255.0 * np.sqrt(np.minimum(reflectance, 1.0)), np.uint8)[:, :, None]


def grey_of(frame: Frame) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Give (H, W) grey that does not change as things come nearer, and (H, W) amplitude.

    A camera that sees colour instead of its own light has its grey for amplitude.

    Raises:
        BadInput: it sees neither, or of another size.
    """
    shades = shades_of(frame)
    if shades is None:
        raise BadInput(f"frame has neither {DEPTH_COLOUR} nor {DEPTH_AMPLITUDE}, by which motion is seen")
    if shades.shape[2] == 1:
        return shades[:, :, 0], frame.depth(DEPTH_AMPLITUDE).astype(np.float32)
    grey = np.asarray(cv2.cvtColor(shades, cv2.COLOR_RGB2GRAY), np.uint8)
    return grey, grey.astype(np.float32)


def _check_size(shape: tuple[int, ...], frame: Frame) -> None:
    depth = frame.depth(DEPTH).shape
    if shape[:2] != depth:
        raise BadInput(f"{DEPTH} and what is seen beside it must have one size: {depth} and {shape[:2]}")
