"""Windows of colour and depth images that are classified as human or not, near and far."""

import math
from enum import StrEnum
from functools import lru_cache
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.sensors.depth.depth_view import Depth, DepthView, Image
from peopleboy.tracker.sensors.depth.v_disparity import HeightLine
from peopleboy.tracker.track import Box

Features = NDArray[np.float32]
_Borders = tuple[int, int, int, int]  # above, below, left, right


class WindowRange(StrEnum):
    """Range of a person: near, with the feet outside the image, or far (SA 4.4.2)."""

    NEAR = "near"
    FAR = "far"


SIZES: Final = {WindowRange.NEAR: (64, 64), WindowRange.FAR: (64, 128)}
"""Width and height [px] of the windows: head and shoulders, and whole body."""

_SAFETY_M: Final = 0.1
_BODY: Final = 104.0 / 128.0  # share of a far window's height that is the body
_SHOULDERS_M: Final = 0.7  # side of a near window
_ABOVE: Final = 0.12  # share of a near window above the head
_RELIEF_M: Final = 0.6  # depth range of a window in front of and behind a body


def range_of(z_m: float, floor: HeightLine, view: DepthView, rows: int) -> WindowRange:
    """Return the range of a detection: far if its feet would be in the image (SA eq. 4.16)."""
    half_angle = math.atan((rows - 0.5 - view.centre_v - view.horizon_px) / view.focal_px)
    farthest = floor.offset_m * math.tan(math.pi / 2.0 - half_angle) + _SAFETY_M
    return WindowRange.FAR if z_m > farthest else WindowRange.NEAR


def window_of(box: Box, z_m: float, kind: WindowRange, floor: HeightLine, view: DepthView) -> Box:
    """Return the window [px] of an object with a box [px] at a depth.

    A far window reaches from the head to the floor, even if legs are occluded.
    """
    left, top, width, height = box
    middle = left + width / 2.0
    if kind is WindowRange.NEAR:
        side = _SHOULDERS_M * view.focal_px / z_m
        return middle - side / 2.0, top - _ABOVE * side, side, side
    foot = float(floor.rows(np.array([z_m]), view)[0])
    body = max(foot - top, height)
    tall = body / _BODY
    return middle - tall / 4.0, top - (tall - body) / 2.0, tall / 2.0, tall


def features(image: Image, window: Box, kind: WindowRange) -> Features:
    """Return the features (N,) of a window of an RGB image."""
    return hog(cut(image, window, kind), kind)


def depth_features(depth: Depth, z_m: float, window: Box, kind: WindowRange) -> Features:
    """Return the features (N,) of a window of a depth image.

    Histograms of oriented depths (Spinello and Arras, IROS 2011): histograms of gradients, of depth.

    Args:
        depth: (H, W) [mm], 0 for no reading.
        z_m: depth of the window's object [m].
        window: [px].
        kind: of window.
    """
    return hog(cut_depth(depth, z_m, window, kind), kind)


def hog(patch: Image, kind: WindowRange) -> Features:
    """Return the histograms of oriented gradients (N,) of a crop."""
    return np.asarray(hog_descriptor(SIZES[kind]).compute(patch), np.float32).ravel()


def cut(image: Image, window: Box, kind: WindowRange) -> Image:
    """Crop a window from an image and resize it; the border is replicated."""
    inside, borders = _inside(window, image.shape[:2])
    return _sized(image[inside], borders, kind)


def cut_depth(depth: Depth, z_m: float, window: Box, kind: WindowRange) -> Image:
    """Crop a window from a depth image [mm] as grey, brighter for farther; missing readings are white."""
    inside, borders = _inside(window, depth.shape[:2])
    inner = depth[inside]
    nearest_mm = 1000.0 * (z_m - _RELIEF_M)
    grey = np.clip((inner - nearest_mm) * (255.0 / (2000.0 * _RELIEF_M)), 0.0, 255.0)
    return _sized(np.where(inner == 0, 255.0, grey).astype(np.uint8), borders, kind)


def _inside(window: Box, shape: tuple[int, ...]) -> tuple[tuple[slice, slice], _Borders]:
    """Return the rows and columns of an image inside a window, and the missing ones at each border."""
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
    # Area averaging, equivalent to a low pass before the reduction.
    smaller = inner.shape[0] >= SIZES[kind][1]
    way = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(inner, SIZES[kind], interpolation=way), np.uint8)


@lru_cache(maxsize=4)
def hog_descriptor(size: tuple[int, int]) -> Any:
    """Return OpenCV's HOG descriptor for windows of a width and height [px].

    Nine directions in cells of 8 px, and blocks of two by two cells.

    Raises:
        BadInput: OpenCV 5 is installed, which has no HOG.
    """
    if not hasattr(cv2, "HOGDescriptor"):
        raise BadInput(
            f"histograms of gradients need OpenCV 4, and {cv2.__version__} is installed: "
            "pip install 'opencv-python-headless<5'"
        )
    return cv2.HOGDescriptor(size, (16, 16), (8, 8), (8, 8), 9)
