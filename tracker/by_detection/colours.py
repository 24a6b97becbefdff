"""What people wear: the colours of torso and legs, where a colour camera sees them."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.by_detection.other_camera import carried_over
from peopleboy.tracker.by_detection.viewpoint import Viewpoint
from peopleboy.tracker.frame import COLOUR, THERMAL, Floats, Frame, PinholeCalibration

Colours = NDArray[np.float32]

_PARTS: Final = ((0.18, 0.5), (0.55, 0.9))  # of torso and legs, from the top, in heights
_WIDE: Final = 0.6  # of the box
_BINS: Final = (4, 8, 8)  # of brightness and of both opponent colours
_SPREAD: Final = 60.0  # of the opponent colours that the bins cover
_DARK: Final = 24.0  # grey up to which nothing is told of colours
_LEAST_PX: Final = 12
_LEAST_INSIDE: Final = 0.6  # share of a part's height in the image: hips are no legs

PARTS: Final = len(_PARTS)
FEATURES: Final = PARTS * _BINS[0] * _BINS[1] * _BINS[2]


def colours_of(frame: Frame, boxes: Floats, view: Viewpoint) -> Colours:
    """Describe who has boxes (M, 4) in the thermal image by colours (M, FEATURES).

    The product of two rows is Bhattacharyya's coefficient: 1 for the same colours, 0 for none in common. Of
    whose torso is not seen a row is 0, and so is the half of legs that are mostly outside the image.
    """
    told = np.zeros((len(boxes), FEATURES), np.float32)
    if COLOUR not in frame.images or len(boxes) == 0:
        return told
    image = frame.rgb(COLOUR)
    there = _seen_there(frame, boxes, view, (image.shape[0], image.shape[1]))
    for row, box in enumerate(there):
        parts = [_histogram(_part(image, box, *part)) for part in _PARTS]
        if parts[0] is None:
            continue
        for half, part, extent in zip(told[row].reshape(PARTS, -1), parts, _PARTS, strict=True):
            if part is not None and _share_inside(box, extent, image.shape[0]) >= _LEAST_INSIDE:
                half[:] = part / np.sqrt(PARTS)
    return told


def alike(one: Colours, other: Colours) -> float:
    """Give Bhattacharyya's coefficient of colours: of the same clothes above 0.8, of others below 0.4."""
    return float(coefficients(one[None], other[None])[0][0, 0])


def coefficients(some: Colours, others: Colours) -> tuple[Colours, NDArray[np.bool_]]:
    """Compare colours (K, FEATURES) and (M, FEATURES) by the parts that are seen of both.

    Returns:
        (K, M) Bhattacharyya's coefficients, 0 where nothing is, and whether something is (K, M).
    """
    ours, theirs = (rows.reshape(len(rows), PARTS, -1) for rows in (some, others))
    seen = np.einsum("kp,mp->km", ours.any(axis=2).astype(np.float32), theirs.any(axis=2).astype(np.float32))
    return some @ others.T * (PARTS / np.maximum(seen, np.float32(1.0))), seen > 0.0


def blended(before: Colours, now: Colours, share: float) -> Colours:
    """Give the colours that are remembered after others are seen, by the parts that are."""
    was, is_ = (one.reshape(PARTS, -1) for one in (before, now))
    gain = np.where(was.any(axis=1), np.float32(share), np.float32(1.0)) * is_.any(axis=1)
    return np.asarray((was + gain[:, None] * (is_ - was)).ravel(), np.float32)


def _seen_there(frame: Frame, boxes: Floats, view: Viewpoint, shape: tuple[int, int]) -> Floats:
    """Carry boxes (M, 4) over to the colour image; one of unknown cameras shows what the thermal one does."""
    thermal, colour = frame.calibrations.get(THERMAL), frame.calibrations.get(COLOUR)
    if not (isinstance(thermal, PinholeCalibration) and isinstance(colour, PinholeCalibration)):
        rows, columns = frame.grey(THERMAL).shape
        return np.asarray(boxes * np.tile([shape[1] / columns, shape[0] / rows], 2))
    return carried_over(boxes, view, thermal, colour)


def _part(image: NDArray[np.uint8], box: Floats, first: float, last: float) -> NDArray[np.uint8]:
    left, top, width, height = box.tolist()
    inset = (1.0 - _WIDE) / 2.0 * width
    rows = slice(max(round(top + first * height), 0), max(round(top + last * height), 0))
    return image[rows, max(round(left + inset), 0) : max(round(left + width - inset), 0)]


def _share_inside(box: Floats, extent: tuple[float, float], rows: int) -> float:
    """Tell which share of a part's height is among the rows of the image."""
    top, bottom = box[1] + box[3] * np.array(extent)
    return float((min(bottom, rows) - max(top, 0.0)) / (bottom - top))


def _histogram(pixels: NDArray[np.uint8]) -> Colours | None:
    """Give the root of the shares (256,) of pixels (h, w, 3) by brightness and opponent colours."""
    if pixels.shape[0] * pixels.shape[1] < _LEAST_PX:
        return None
    red, green, blue = (pixels[..., k].astype(np.float32).ravel() for k in range(3))
    light = (red + green + blue) / 3.0
    if float(light.mean()) < _DARK:
        return None
    planes = np.stack([light * (_SPREAD / 128.0) - _SPREAD, red - green, blue - (red + green) / 2.0], axis=1)
    clipped = np.clip(planes, -_SPREAD + 1e-3, _SPREAD - 1e-3)
    bins = cv2.calcHist(
        [np.ascontiguousarray(clipped[None])], [0, 1, 2], None, list(_BINS), [-_SPREAD, _SPREAD] * 3
    )
    return np.asarray(np.sqrt(bins.ravel() / bins.sum()), np.float32)
