"""Windows of colour and depth images that a detector of humans looks at, near and far."""

from __future__ import annotations

import math
from enum import StrEnum
from functools import lru_cache
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.rgbd.depth_view import Depth, DepthView
from peopleboy.tracker.rgbd.pre_detection import PreDetection
from peopleboy.tracker.rgbd.v_disparity import HeightLine
from peopleboy.tracker.track import Box

Image = NDArray[np.uint8]
Features = NDArray[np.float32]
_Borders = tuple[int, int, int, int]  # above, below, left, right


class WindowRange(StrEnum):
    """How far a person is: so near that the feet are cut off, or farther (SA 4.4.2)."""

    NEAR = "near"
    FAR = "far"


SIZES: Final = {WindowRange.NEAR: (64, 64), WindowRange.FAR: (64, 128)}
"""Width and height [px] of the windows: of head and shoulders, and of a whole body."""

_SAFETY_M: Final = 0.1
_BODY: Final = 104.0 / 128.0  # of a far window's height is body
_SHOULDERS_M: Final = 0.7  # side of a near window
_ABOVE: Final = 0.12  # of a near window is above the head
_RELIEF_M: Final = 0.6  # before and behind a body, that its window shows of the depth


def range_of(z_m: float, floor: HeightLine, view: DepthView, rows: int) -> WindowRange:
    """Return how far something is: far from where feet are in the image on (SA eq. 4.16)."""
    half_angle = math.atan((rows / 2.0 + view.horizon_px) / view.focal_px)
    farthest = floor.offset_m * math.tan(math.pi / 2.0 - half_angle) + _SAFETY_M
    return WindowRange.FAR if z_m > farthest else WindowRange.NEAR


def window_of(found: PreDetection, kind: WindowRange, floor: HeightLine, view: DepthView) -> Box:
    """Place a window [px] on what was found.

    A far one reaches from the head to the floor, though legs may be hidden.
    """
    left, top, width, height = found.box
    middle = left + width / 2.0
    if kind is WindowRange.NEAR:
        side = _SHOULDERS_M * view.focal_px / found.z_m
        return middle - side / 2.0, top - _ABOVE * side, side, side
    foot = float(floor.rows(np.array([found.z_m]), view)[0])
    body = max(foot - top, height)
    tall = body / _BODY
    return middle - tall / 4.0, top - (tall - body) / 2.0, tall / 2.0, tall


def features(image: Image, window: Box, kind: WindowRange) -> Features:
    """Describe a window of an RGB image by numbers (N,)."""
    return hog(cut(image, window, kind), kind)


def depth_features(depth: Depth, z_m: float, window: Box, kind: WindowRange) -> Features:
    """Describe a window of a depth image by numbers (N,).

    They are histograms of oriented depths (Spinello & Arras, IROS 2011): those of gradients, of depth.

    Args:
        depth: (H, W) [mm], 0 for unknown.
        z_m: depth of what the window is about [m].
        window: [px].
        kind: of window.
    """
    return hog(cut_depth(depth, z_m, window, kind), kind)


def hog(patch: Image, kind: WindowRange) -> Features:
    """Return the histograms of oriented gradients (N,) of what was cut out."""
    return np.asarray(hog_descriptor(SIZES[kind]).compute(patch), np.float32).ravel()


def cut(image: Image, window: Box, kind: WindowRange) -> Image:
    """Cut a window out of an image and bring it to its size; beyond the border it goes on as it ends."""
    inside, borders = _inside(window, image.shape[:2])
    return _sized(image[inside], borders, kind)


def cut_depth(depth: Depth, z_m: float, window: Box, kind: WindowRange) -> Image:
    """Cut a window out of a depth image [mm] as grey: the farther the brighter; what is unknown is white."""
    inside, borders = _inside(window, depth.shape[:2])
    inner = depth[inside]
    nearest_mm = 1000.0 * (z_m - _RELIEF_M)
    grey = np.clip((inner - nearest_mm) * (255.0 / (2000.0 * _RELIEF_M)), 0.0, 255.0)
    return _sized(np.where(inner == 0, 255.0, grey).astype(np.uint8), borders, kind)


def _inside(window: Box, shape: tuple[int, ...]) -> tuple[tuple[slice, slice], _Borders]:
    """Return which rows and columns of an image a window has, and how many it lacks at each border."""
    left, top, width, height = window
    first_u, first_v = math.floor(left), math.floor(top)
    last_u, last_v = max(math.ceil(left + width), first_u + 2), max(math.ceil(top + height), first_v + 2)
    rows, columns = shape
    inside = (
        slice(min(max(first_v, 0), rows - 1), max(min(last_v, rows), 1)),
        slice(min(max(first_u, 0), columns - 1), max(min(last_u, columns), 1)),
    )
    return inside, (max(-first_v, 0), max(last_v - rows, 0), max(-first_u, 0), max(last_u - columns, 0))


def _sized(inner: Image, borders: _Borders, kind: WindowRange) -> Image:
    if any(borders):
        inner = cv2.copyMakeBorder(inner, *borders, cv2.BORDER_REPLICATE).astype(np.uint8, copy=False)
    # Mean of the pixels that fall together: as if blurred before it is made smaller.
    smaller = inner.shape[0] >= SIZES[kind][1]
    way = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(inner, SIZES[kind], interpolation=way), np.uint8)


@lru_cache(maxsize=4)
def hog_descriptor(size: tuple[int, int]) -> Any:
    """Return OpenCV's HOG of windows of a width and height [px].

    It has nine directions in cells of 8 px, and blocks of two by two cells.

    Raises:
        BadInput: it is OpenCV 5, which has none.
    """
    if not hasattr(cv2, "HOGDescriptor"):
        raise BadInput(
            f"histograms of gradients need OpenCV 4, and {cv2.__version__} is installed: "
            "pip install 'opencv-python-headless<5'"
        )
    return cv2.HOGDescriptor(size, (16, 16), (8, 8), (8, 8), 9)
