"""Appearance of people: colour histograms of torso and legs, and small thermal patterns."""

import math
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import COLOUR, THERMAL, Floats, Frame
from peopleboy.tracker.tracking.viewpoint import Viewpoint

# Transfer of boxes from one camera to another camera on the same robot.


def transfer_boxes(
    boxes: Floats, view: Viewpoint, here: PinholeCalibration, there: PinholeCalibration
) -> Floats:
    """Return boxes (M, 4) [px] of one image in the other image, assuming that everybody has the same height.

    Args:
        boxes: in the image of the first camera.
        view: viewpoint of the first camera.
        here: calibration of the first camera.
        there: calibration of the other camera.

    Returns:
        (M, 4) [px], 0 for people outside the other camera's view.
    """
    ahead = view.feet(boxes)[:, 2:] - view.at_m[2]
    left, top, width, height = boxes.T
    ends = [np.stack([left + width / 2.0, row], axis=1) for row in (top, top + height)]
    # All points of a person are assumed to have the depth of the feet.
    points = [here.rays(end) for end in ends]
    level = [ray / np.maximum(ray[:, :1], 1e-3) * ahead + np.array(here.position_m) for ray in points]
    above, below = (there.project(end) for end in level)
    tall = below[:, 1] - above[:, 1]
    wide = tall * width / height
    boxed = np.stack([(above[:, 0] + below[:, 0] - wide) / 2.0, above[:, 1], wide, tall], axis=1)
    return np.asarray(np.nan_to_num(boxed))


def boxes_in_other_image(
    frame: Frame, boxes: Floats, here: str, there: str, view: Viewpoint | None = None
) -> Floats:
    """Transfer boxes (M, 4) [px] between the images of two cameras; uncalibrated ones are assumed aligned.

    Args:
        frame: with an image of both cameras.
        boxes: in the image of the first camera.
        here: name of the first camera.
        there: name of the other camera.
        view: viewpoint of the first camera; None for that of its calibration.
    """
    first, other = frame.calibrations.get(here), frame.calibrations.get(there)
    (rows, columns), (other_rows, other_columns) = (frame.images[name].shape[:2] for name in (here, there))
    if not (isinstance(first, PinholeCalibration) and isinstance(other, PinholeCalibration)):
        return np.asarray(boxes * np.tile([other_columns / columns, other_rows / rows], 2))
    return transfer_boxes(boxes, view or Viewpoint.of(first, (rows, columns)), first, other)


Colours = NDArray[np.float32]

_PARTS: Final = ((0.18, 0.5), (0.55, 0.9))  # top and bottom of torso and legs, in heights from the top
_WIDE: Final = 0.6  # share of the box's width that is sampled
_BINS: Final = (4, 8, 8)  # bins of brightness and of both opponent colours
_SPREAD: Final = 60.0  # range of the opponent colours that the bins cover
_WHITE: Final = 256.0
_DARK: Final = 24.0  # grey below which colours are ignored
_LEAST_PX: Final = 12
_LEAST_INSIDE: Final = 0.6
"""Least share of a part's height inside the image: hips are not legs.

Without a known floor the extent of legs below the image is unknown, and the visible part counts.
"""

PARTS: Final = len(_PARTS)
FEATURES: Final = PARTS * _BINS[0] * _BINS[1] * _BINS[2]


def describe_colours(frame: Frame, boxes: Floats, view: Viewpoint) -> Colours:
    """Return the colour descriptors (M, FEATURES) of people with boxes (M, 4) in the thermal image.

    The product of two rows is the Bhattacharyya coefficient: 1 for equal colours, 0 for disjoint ones. A row
    is 0 if the torso is not visible; with a calibrated camera the half for the legs is 0 if most of them are
    outside the image.
    """
    result = np.zeros((len(boxes), FEATURES), np.float32)
    if COLOUR not in frame.images or len(boxes) == 0:
        return result
    image = frame.rgb(COLOUR)
    there = boxes_in_other_image(frame, boxes, THERMAL, COLOUR, view)
    least = -np.inf if view.floor_m is None else _LEAST_INSIDE
    _describe(image, there, np.array(_PARTS), least, result)
    return result


def describe_samples(samples: NDArray[np.uint8], down: Floats) -> Colours:
    """Return the colours (FEATURES,) of single pixels of a person.

    Args:
        samples: (N, 3) RGB.
        down: (N,) how far below the top of the head each is, in heights.
    """
    result = np.zeros(FEATURES, np.float32)
    size = FEATURES // PARTS
    for part, (first, last) in enumerate(_PARTS):
        pixels = samples[(down >= first) & (down < last)]
        is_seen = _histogram(pixels[None], result[part * size : (part + 1) * size])
        if part == 0 and not is_seen:
            break
    return result


def colour_similarity(one: Colours, other: Colours) -> float:
    """Return the Bhattacharyya coefficient of colours: above 0.8 for equal clothes, below 0.4 for others."""
    return float(one @ other) * PARTS / max(_common_parts(one, other), 1)


def colour_similarities(some: Colours, others: Colours) -> tuple[Colours, NDArray[np.bool_]]:
    """Compare colours (K, FEATURES) and (M, FEATURES) by the parts that are visible in both.

    Returns:
        (K, M) Bhattacharyya coefficients, 0 without a common part, and (K, M) whether there is a common part.
    """
    ours, theirs = (_are_seen(rows).astype(np.float32) for rows in (some, others))
    seen = ours @ theirs.T
    return some @ others.T * (PARTS / np.maximum(seen, np.float32(1.0))), seen > 0.0


def blend_colours(before: Colours, now: Colours, share: float) -> Colours:
    """Return the remembered colours, updated with the parts that are visible now."""
    result = np.empty_like(before)
    _blend(before, now, np.float32(share), result)
    return result


def _are_seen(colours: Colours) -> NDArray[np.bool_]:
    """Return for colours (K, FEATURES) which parts are visible, (K, PARTS)."""
    return np.asarray(colours.reshape(len(colours), PARTS, -1).max(axis=2) > 0.0)


@njit(cache=True, nogil=True)
def _describe(
    image: NDArray[np.uint8],
    boxes: Floats,
    parts: Floats,
    least: float,
    result: Colours,
) -> None:  # pragma: no cover
    """Describe boxes (M, 4) of an image (H, W, 3) by parts (2, 2) with a least share inside the image."""
    rows = float(image.shape[0])
    size = result.shape[1] // len(parts)
    for number, (left, top, width, height) in enumerate(boxes):
        inset = (1.0 - _WIDE) / 2.0 * width
        begin, end = max(round(left + inset), 0), max(round(left + width - inset), 0)
        for part, (first, last) in enumerate(parts):
            upper, lower = top + first * height, top + last * height
            pixels = image[max(round(upper), 0) : max(round(lower), 0), begin:end]
            bins = result[number, part * size : (part + 1) * size]
            is_seen = _histogram(pixels, bins)
            if part == 0 and not is_seen:
                break
            if is_seen and (min(lower, rows) - max(upper, 0.0)) / (lower - upper) < least:
                bins[:] = np.float32(0.0)


@njit(cache=True, nogil=True)
def _histogram(pixels: NDArray[np.uint8], bins: Colours) -> bool:  # pragma: no cover
    """Return square roots of pixel shares (h, w, 3) by brightness and opponent colours, if enough are seen.

    Each pixel is shared by the eight nearest bins, so that a small change of light has a small effect. The
    squares of all parts add up to 1.
    """
    count, total = pixels.shape[0] * pixels.shape[1], 0.0
    if count < _LEAST_PX:
        return False
    low, over, strides = np.empty(3, np.int64), np.empty(3, np.float32), (_BINS[1] * _BINS[2], _BINS[2], 1)
    for row in pixels:
        for one in row:
            red, green, blue = float(one[0]), float(one[1]), float(one[2])
            total += red + green + blue
            values = (
                (red + green + blue) / (3.0 * _WHITE),
                (red - green) / (2.0 * _SPREAD) + 0.5,
                (2.0 * blue - red - green) / (4.0 * _SPREAD) + 0.5,
            )
            for axis in range(3):
                place = min(max(values[axis] * _BINS[axis] - 0.5, 0.0), _BINS[axis] - 1.0)
                low[axis] = min(int(place), _BINS[axis] - 2)
                over[axis] = np.float32(place - low[axis])
            for corner in range(8):
                share, at = np.float32(1.0), 0
                for axis in range(3):
                    upper = (corner >> axis) & 1
                    share *= over[axis] if upper else np.float32(1.0) - over[axis]
                    at += (low[axis] + upper) * strides[axis]
                bins[at] += share
    is_light = bool(total / (3.0 * count) >= _DARK)
    for k in range(len(bins)):
        bins[k] = math.sqrt(bins[k] / np.float32(count)) / math.sqrt(PARTS) if is_light else 0.0
    return is_light


@njit(cache=True, nogil=True)
def _common_parts(one: Colours, other: Colours) -> int:  # pragma: no cover
    """Count the parts that are visible in both."""
    count, size = 0, len(one) // PARTS
    for first in range(0, len(one), size):
        if one[first : first + size].any() and other[first : first + size].any():
            count += 1
    return count


@njit(cache=True, nogil=True)
def _blend(before: Colours, now: Colours, share: np.float32, result: Colours) -> None:  # pragma: no cover
    size = len(before) // PARTS
    for first in range(0, len(before), size):
        part = slice(first, first + size)
        was, seen, put = before[part], now[part], result[part]
        gain = np.float32(0.0)
        if seen.any():
            gain = share if was.any() else np.float32(1.0)
        for k in range(size):
            put[k] = was[k] + gain * (seen[k] - was[k])


# Thermal appearance: a small pattern of warm and cold.

Pattern = NDArray[np.float32]

ROWS: Final = 12
COLUMNS: Final = 6
SAMPLES: Final = ROWS * COLUMNS
_FAINT_GREY: Final = 4.0  # contrast below which a pattern is mostly noise


def describe_patterns(image: NDArray[np.float32], boxes: NDArray[np.float64]) -> Pattern:
    """Return the patterns (M, SAMPLES) of boxes (M, 4) of an image (H, W), with mean 0 and length up to 1.

    They do not depend on the brightness or contrast of the image.
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
