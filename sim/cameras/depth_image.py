"""Depth images, in millimetres: how they are stored, their points, and how people are shown them."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.geometry.pinhole import Pinhole

_BRIGHT_AMPLITUDE = 2500.0

Metres = NDArray[np.float32]
Millimetres = NDArray[np.uint16]

_BRIGHT_M, _DARK_M, _DARK = 1.0, 12.0, 50  # how near is brightest, how far is darkest, and how bright that is


def to_millimetres(depth_m: Metres, config: DepthConfig) -> Millimetres:
    """Encode (H, W) depths [m]: 0 for those outside the sensor's range, and for NaN and infinity."""
    is_read = (depth_m >= config.nearest_m) & (depth_m <= config.farthest_m)
    return np.where(is_read, np.rint(1000.0 * np.where(is_read, depth_m, 0.0)), 0.0).astype(np.uint16)


def points_of(depth: Millimetres, camera: Pinhole, every: int) -> tuple[Metres, NDArray[np.int64]]:
    """Find the points that every so-manieth pixel of every so-manieth row of a depth image stands for.

    Returns:
        (N, 3) [m] in the optical frame, x right, y down, z forward; and (N, 2) the row and the column of
        each. Pixels where nothing is read have none.
    """
    first = every // 2
    pixels = first + every * np.argwhere(depth[first::every, first::every])
    z = depth[pixels[:, 0], pixels[:, 1]] / 1000.0
    x, y = ((pixels[:, 1 - k] - camera.centre_px[k]) / camera.focal_px * z for k in (0, 1))
    return np.stack([x, y, z], axis=1).astype(np.float32), pixels


def show_depth(depth: Millimetres) -> NDArray[np.uint8]:
    """Turn an (H, W) depth image into an RGB one: the nearer the brighter, and black where nothing is read.

    A colour tells depth alone, whatever the sensor's range: brightest up to 1 m, darkest from 12 m on, and
    as the logarithm goes between them.
    """
    return _SHADES[depth]


def show_amplitude(amplitude: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Turn an (H, W) amplitude image into a grey one: the root, white from that of a white wall at 2 m on."""
    share = np.minimum(amplitude / np.float32(_BRIGHT_AMPLITUDE), 1.0)
    return np.rint(255.0 * np.sqrt(share)).astype(np.uint8)


def _shades() -> NDArray[np.uint8]:
    """(65536, 3) RGB of each depth [mm]."""
    depth_m = np.maximum(np.arange(65536), 1) / 1000.0
    share = np.clip(np.log(depth_m / _BRIGHT_M) / math.log(_DARK_M / _BRIGHT_M), 0.0, 1.0)
    levels = np.rint(255.0 - (255.0 - _DARK) * share).astype(np.uint8)
    shades = cv2.applyColorMap(levels[:, None], cv2.COLORMAP_INFERNO)[:, 0, ::-1].copy()
    shades[0] = 0
    return np.asarray(shades, np.uint8)


_SHADES = _shades()
