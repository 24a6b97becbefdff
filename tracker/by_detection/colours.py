"""What people wear: the colours of torso and legs, where a colour camera sees them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
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
_LEAST_INSIDE: Final = 0.6
"""Share of a part's height in the image: hips are no legs.

Where the floor is not known nobody knows how far legs go on below the image, and what is seen counts.
"""

PARTS: Final = len(_PARTS)
FEATURES: Final = PARTS * _BINS[0] * _BINS[1] * _BINS[2]


def colours_of(frame: Frame, boxes: Floats, view: Viewpoint) -> Colours:
    """Describe who has boxes (M, 4) in the thermal image by colours (M, FEATURES).

    The product of two rows is Bhattacharyya's coefficient: 1 for the same colours, 0 for none in common. Of
    whose torso is not seen a row is 0, and so is the half of legs that are mostly outside the image of a
    camera that is known.
    """
    told = np.zeros((len(boxes), FEATURES), np.float32)
    if COLOUR not in frame.images or len(boxes) == 0:
        return told
    image = frame.rgb(COLOUR)
    there = _seen_there(frame, boxes, view, (image.shape[0], image.shape[1]))
    least = -np.inf if view.floor_m is None else _LEAST_INSIDE
    for row, box in enumerate(there):
        parts = [_histogram(_part(image, box, *part)) for part in _PARTS]
        if parts[0] is None:
            continue
        for half, part, extent in zip(told[row].reshape(PARTS, -1), parts, _PARTS, strict=True):
            if part is not None and _share_inside(box, extent, image.shape[0]) >= least:
                half[:] = part / np.sqrt(PARTS)
    return told


def alike(one: Colours, other: Colours) -> float:
    """Give Bhattacharyya's coefficient of colours: of the same clothes above 0.8, of others below 0.4."""
    ours, theirs = one.reshape(PARTS, -1).any(axis=1), other.reshape(PARTS, -1).any(axis=1)
    return float(one @ other) * PARTS / max(int(np.count_nonzero(ours & theirs)), 1)


def coefficients(some: Colours, others: Colours) -> tuple[Colours, NDArray[np.bool_]]:
    """Compare colours (K, FEATURES) and (M, FEATURES) by the parts that are seen of both.

    Returns:
        (K, M) Bhattacharyya's coefficients, 0 where nothing is, and whether something is (K, M).
    """
    ours, theirs = (_are_seen(rows).astype(np.float32) for rows in (some, others))
    seen = ours @ theirs.T
    return some @ others.T * (PARTS / np.maximum(seen, np.float32(1.0))), seen > 0.0


def blended(before: Colours, now: Colours, share: float) -> Colours:
    """Give the colours that are remembered after others are seen, by the parts that are."""
    was, is_ = (one.reshape(PARTS, -1) for one in (before, now))
    gain = np.where(_are_seen(before[None])[0], np.float32(share), np.float32(1.0)) * _are_seen(now[None])[0]
    return np.asarray((was + gain[:, None] * (is_ - was)).ravel(), np.float32)


def _are_seen(colours: Colours) -> NDArray[np.bool_]:
    """Tell of colours (K, FEATURES) of which parts (K, PARTS) something is seen."""
    return np.asarray(colours.reshape(len(colours), PARTS, -1).max(axis=2) > 0.0)


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
    count = pixels.shape[0] * pixels.shape[1]
    if count < _LEAST_PX:
        return None
    bins = np.zeros(_BINS, np.float32)
    light = _count(pixels, *_BIN_OF, bins)
    return None if light / (3 * count) < _DARK else np.sqrt(bins.ravel() / np.float32(count))


def _bins_of(values: Floats, bins: int) -> NDArray[np.uint8]:
    """Tell in which of so many bins values are; what is beyond -_SPREAD to _SPREAD is in the outer ones."""
    return np.clip(np.floor((values + _SPREAD) * bins / (2.0 * _SPREAD)), 0, bins - 1).astype(np.uint8)


# Of red + green + blue from 0 on, red - green from -255 on, and 2 blue - red - green from -510 on.
_BIN_OF: Final = (
    _bins_of(np.arange(766.0) / 3.0 * (_SPREAD / 128.0) - _SPREAD, _BINS[0]),
    _bins_of(np.arange(-255.0, 256.0), _BINS[1]),
    _bins_of(np.arange(-510.0, 511.0) / 2.0, _BINS[2]),
)


@njit(cache=True, nogil=True)
def _count(
    pixels: NDArray[np.uint8],
    of_light: NDArray[np.uint8],
    of_red: NDArray[np.uint8],
    of_blue: NDArray[np.uint8],
    bins: Colours,
) -> int:  # pragma: no cover
    """Count pixels in bins, and give the sum of all they have of red, green and blue."""
    total = 0
    for row in pixels:
        for one in row:
            red, green, blue = int(one[0]), int(one[1]), int(one[2])
            light = red + green + blue
            bins[of_light[light], of_red[red - green + 255], of_blue[2 * blue - red - green + 510]] += 1.0
            total += light
    return total
