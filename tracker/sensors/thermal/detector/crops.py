"""Input of rescoring and box refinement: a crop around each detection, and a few further features."""

import math
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.inference import CHANNELS, CropSize
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.window import Floats

Grey = NDArray[np.uint8]
Crops = NDArray[np.uint8]
Planes = NDArray[np.float32]

FEATURES: Final = 9
"""Number of `crop_features` of a detection."""
SCORES: Final = 4.0
"""Unit of the first feature, the score, in log-odds."""

_USUAL_PX: Final = 80.0  # typical height of people
_STATURE_M: Final = 1.7  # mean stature
_MOST: Final = 2.0
_SHARPNESS: Final = 6.0  # scale of the logarithm of the stature
_LEAST_GREY: Final = 2.0  # standard deviation below which contrast is noise
_MOST_GREY: Final = 4.0  # in standard deviations
_FLAGS: Final = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP


def cut_crops(grey: Grey, change: Grey, boxes: Floats, size: CropSize) -> Crops:
    """Crop boxes (N, 4) [px] with their surroundings from an image, (N, rows, columns, 3).

    Args:
        grey: (H, W) image.
        change: (H, W) change of the greys.
        boxes: from head to feet; each crop is centred on its box.
        size: of the crops.
    """
    rows, columns, heights = size
    crops = np.zeros((len(boxes), rows, columns, CHANNELS), np.uint8)
    images = [(grey, change)]
    for crop, (left, top, width, height) in zip(crops, boxes.tolist(), strict=True):
        scale = heights * height / rows  # [px] of the image per pixel of the crop
        halvings = max(int(np.floor(np.log2(scale) + 0.25)), 0)
        while len(images) <= halvings:
            images.append((_half(images[-1][0]), _half(images[-1][1])))
        half = 0.5**halvings
        middle = (left + width / 2.0 + 0.5, top + height / 2.0 + 0.5)
        begin = [(m - scale * px / 2.0) * half for m, px in zip(middle, (columns, rows), strict=True)]
        step = scale * half
        turn = np.array([[step, 0.0, begin[0] + step / 2.0 - 0.5], [0.0, step, begin[1] + step / 2.0 - 0.5]])
        for plane, image in enumerate(images[halvings]):
            crop[..., plane] = cv2.warpAffine(
                image, turn, (columns, rows), flags=_FLAGS, borderMode=cv2.BORDER_REPLICATE
            )
        _mark_inside(crop, step, turn[0, 2], turn[1, 2], *images[halvings][0].shape)
    return crops


def normalise_crops(crops: Crops) -> Planes:
    """Normalise crops (N, rows, columns, 3) by mean and deviation, so that gain and offset cancel out."""
    planes = np.empty(crops.shape, np.float32)
    for crop, plane in zip(crops, planes, strict=True):
        _normalise(crop.reshape(-1, CHANNELS), plane.reshape(-1, CHANNELS))
    return planes


@njit(cache=True, nogil=True)
def _normalise(crop: Crops, planes: Planes) -> None:  # pragma: no cover
    """Normalise pixels (M, 3) by mean and standard deviation of those inside the image."""
    count, total, squares = 0, 0.0, 0.0
    for one, _, inside in crop:
        if inside > 0:
            grey = float(one)
            count, total, squares = count + 1, total + grey, squares + grey * grey
    mean = total / max(count, 1)
    spread = math.sqrt(max(squares / max(count, 1) - mean * mean, 0.0)) + _LEAST_GREY
    middle, share, most = np.float32(mean), np.float32(1.0 / spread), np.float32(_MOST_GREY)
    for k in range(len(crop)):
        is_inside = np.float32(crop[k, 2] > 0)
        z = (np.float32(crop[k, 0]) - middle) * share * is_inside
        planes[k, 0] = min(max(z, -most), most)
        planes[k, 1] = min(np.float32(crop[k, 1]) * share * is_inside, most)
        planes[k, 2] = is_inside


def crop_features(found: Detections, crops: Crops, shape: tuple[int, int], mount: Mount | None) -> Planes:
    """Return features of detections that are not visible in crops (N, rows, columns, 3).

    Args:
        found: N detections.
        crops: of the detections.
        shape: rows and columns of the image.
        mount: of the camera; None if unknown.

    Returns:
        (N, 9) score, logarithm of the height, shares above, below, left and right of the image, logarithm of
        the contrast, logarithm of the stature of a person standing on the floor at that position, and whether
        the stature is known.
    """
    rows, columns = shape
    left, top, width, height = found.box.T
    over = [-top / height, (top + height - rows) / height, -left / width, (left + width - columns) / width]
    contrast = np.log((_deviations(crops) + 1.0) / 30.0)
    stature, is_known = np.zeros(len(crops)), np.zeros(len(crops))
    if mount is not None:
        below = np.maximum(top + height - mount.horizon_px, 1e-3)
        stature = np.clip(_SHARPNESS * np.log(mount.height_m * height / below / _STATURE_M), -_MOST, _MOST)
        is_known[:] = 1.0
    listed = [found.score / SCORES, np.log2(height / _USUAL_PX), *(np.clip(one, 0.0, 1.0) for one in over)]
    return np.stack([*listed, contrast, stature, is_known], axis=1).astype(np.float32)


def _half(image: Grey) -> Grey:
    rows, columns = image.shape
    half = (max((columns + 1) // 2, 1), max((rows + 1) // 2, 1))
    return np.asarray(cv2.resize(image, half, interpolation=cv2.INTER_AREA), np.uint8)


@njit(cache=True, nogil=True)
def _mark_inside(
    crop: Crops, step: float, left: float, top: float, rows: int, columns: int
) -> None:  # pragma: no cover
    """Mark the pixels of a crop that lie inside an image, in which they are `step` apart."""
    for i in range(crop.shape[0]):
        down = step * i + top
        is_row = -0.5 < down < rows - 0.5
        for j in range(crop.shape[1]):
            right = step * j + left
            crop[i, j, 2] = 255 * (is_row and -0.5 < right < columns - 0.5)


@njit(cache=True, nogil=True)
def _deviations(crops: Crops) -> Floats:  # pragma: no cover
    """Return the standard deviations (N,) of the greys of crops."""
    deviation = np.empty(len(crops))
    for number in range(len(crops)):
        total, squares = 0, 0
        crop = crops[number]
        for i in range(crop.shape[0]):
            for j in range(crop.shape[1]):
                grey = int(crop[i, j, 0])
                total, squares = total + grey, squares + grey * grey
        pixels = crop.shape[0] * crop.shape[1]
        deviation[number] = math.sqrt(float(pixels * squares - total * total)) / pixels
    return deviation
