"""The channels in which colours are compared."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.colour_config import ColourConfig

_FULL_TURN = 256


def channels_of(colour: NDArray[np.uint8], config: ColourConfig) -> NDArray[np.uint8]:
    """Turn an RGB image (H, W, 3) into the channels (H, W, C) uint8 of the configured space.

    Hue is an angle, and its mean must not depend on where red begins: for moments, hue and saturation are
    the place in the colour disc, ((1 + S cos H) / 2, (1 + S sin H) / 2). Histograms take H, S, V as they are.
    """
    if config.space == "grey":
        return np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), np.uint8)[..., None]
    if config.space == "rgb":
        return np.ascontiguousarray(colour)
    hsv = np.asarray(cv2.cvtColor(colour, cv2.COLOR_RGB2HSV_FULL), np.uint8)
    return hsv if config.moments == 0 else _disc(hsv)


def _disc(hsv: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Place hue and saturation in the colour disc, (H, W, 3) in and out."""
    angle = np.arange(_FULL_TURN) * (2 * np.pi / _FULL_TURN)
    hue, saturation = hsv[..., 0], hsv[..., 1].astype(np.float32)
    result = hsv.copy()
    for channel, turn in enumerate((np.cos(angle), np.sin(angle))):
        result[..., channel] = np.rint(127.5 + 0.5 * saturation * turn.astype(np.float32)[hue])
    return result
