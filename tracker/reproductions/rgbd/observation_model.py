"""Observation model: colours and depth in the image at positions on the floor."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.sensors.depth.depth_view import Depth, Image, RgbdView, project_body
from peopleboy.tracker.track import Box

# Appearance of a person: a histogram of hue and saturation (SA 4.6).

HUES: Final = 12
SATURATIONS: Final = 6
GREYS: Final = 4
BINS: Final = HUES * SATURATIONS + GREYS

_LEAST_SATURATION: Final = 26
_DARKEST: Final = 40
_BRIGHTEST: Final = 250
_BITS: Final = 5  # most significant bits of each colour that select the bin


@lru_cache(maxsize=1)
def bin_of_colour() -> NDArray[np.uint8]:
    """Tabulate the bin of each colour (32768,) with five bits per channel.

    The source drops colours with too little or too much of hue or saturation; here they have bins by
    brightness, as otherwise black clothes have no histogram at all.
    """
    step = np.arange(1 << _BITS, dtype=np.uint8) * 8 + 4
    red, green, blue = np.meshgrid(step, step, step, indexing="ij")
    colours = np.stack([red, green, blue], axis=-1).reshape(1, -1, 3)
    hue, saturation, value = (
        channel.astype(np.int64) for channel in cv2.split(cv2.cvtColor(colours, cv2.COLOR_RGB2HSV))
    )
    coloured = hue * HUES // 180 * SATURATIONS + saturation * SATURATIONS // 256
    grey = HUES * SATURATIONS + value * GREYS // 256
    is_grey = (saturation < _LEAST_SATURATION) | (value < _DARKEST) | (value > _BRIGHTEST)
    return np.where(is_grey, grey, coloured).astype(np.uint8).ravel()


def similarity(one: Floats, other: Floats) -> float:
    """Return the Bhattacharyya coefficient of two histograms, 1 for equal ones (SA eq. 4.25).

    The source prints a comma between the two; their product is meant.
    """
    return float(np.sqrt(one * other).sum())


@njit(cache=True, nogil=True)
def bin_at(image: NDArray[np.uint8], v: int, u: int, table: NDArray[np.uint8]) -> int:
    """Look up the bin of a pixel."""
    red, green, blue = image[v, u, 0] >> 3, image[v, u, 1] >> 3, image[v, u, 2] >> 3
    return int(table[(red << 10) | (green << 5) | blue])


COLUMNS: Final = 10
ROWS: Final = 20
_MIDDLE: Final = np.array([3, 7, 5, 15])  # columns from, to, rows from, to, in which the depth is measured
_LEAST_SAMPLES: Final = 20
_NOWHERE_M: Final = 10.0
_OFF_M: Final = 0.5  # depth difference from which a reading belongs to another object


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """Size and appearance of a person.

    Attributes:
        width_m: [m].
        head_m, low_m: [m] heights above the floor of the top and of the lowest visible part.
        appearance: (BINS,) histogram.
    """

    width_m: float
    head_m: float
    low_m: float
    appearance: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Glance:
    """Readings at P positions.

    Attributes:
        similarity: (P,) similarity of the colours to those of a body, 0..1.
        miss_m: (P,) [m] distance from the position to the measured middle of its box.
        nearer, beyond: (P,) share of readings more than half a metre in front of and behind it.
    """

    similarity: Floats
    miss_m: Floats
    nearer: Floats
    beyond: Floats


def look_at(view: RgbdView, places_m: Floats, body: Body, foreground_m: float) -> Glance:
    """Evaluate the images at positions (P, 2) in the robot frame."""
    pose = view.geometry.calibration.robot_from_camera
    measured = _glances(
        view.depth,
        view.colour,
        np.ascontiguousarray(pose[:3, :3]),
        np.ascontiguousarray(pose[:3, 3]),
        np.array([view.geometry.focal_px, view.geometry.centre_u, view.geometry.centre_v]),
        np.ascontiguousarray(places_m),
        np.array([body.width_m, body.head_m, body.low_m, view.body_m]),
        body.appearance,
        foreground_m if foreground_m > 0.0 else math.inf,
        bin_of_colour(),
    )
    return Glance(measured[:, 0], measured[:, 1], measured[:, 2], measured[:, 3])


def colours_in(view: RgbdView, box: Box) -> Floats:
    """Return the histogram (BINS,) of the foreground in a box (SA eq. 4.24).

    The foreground is the largest connected part of the nearer of two clusters of depths (SA 4.4.2).
    """
    readings, bins = _readings_in(view.depth, view.colour, np.array(box), bin_of_colour())
    if not readings.any():
        return np.zeros(BINS)
    is_near = (readings > 0.0) & (readings <= _between_two(readings[readings > 0.0]))
    _, parts, boxes, _ = cv2.connectedComponentsWithStats(is_near.astype(np.uint8), connectivity=8)
    largest = 1 + int(np.argmax(boxes[1:, cv2.CC_STAT_AREA]))
    counts = np.bincount(bins[parts == largest], minlength=BINS)
    return np.asarray(counts / counts.sum(), np.float64)


@njit(cache=True, nogil=True)
def _glances(
    depth: Depth,
    colour: Image,
    rotation: Floats,
    origin: Floats,
    camera: Floats,
    places: Floats,
    body: Floats,
    appearance: Floats,
    foreground_m: float,
    table: NDArray[np.uint8],
) -> Floats:
    """Return similarity, miss, share nearer, share beyond (P, 4)."""
    found = np.zeros((len(places), 4))
    found[:, 1] = _NOWHERE_M
    samples = np.zeros((COLUMNS * ROWS, 4))
    for n in range(len(places)):
        left, top, width, height, z = project_body(
            rotation, origin, camera, places[n], body[0], body[1], body[2]
        )
        if z <= 0.0:
            continue
        count = _sample(depth, left, top, width, height, samples)
        off = samples[:count, 2] + body[3] - z
        is_read = samples[:count, 2] > 0.0
        readings = is_read.sum()
        if readings == 0:
            continue
        found[n, 2] = (is_read & (off < -_OFF_M)).sum() / readings
        found[n, 3] = (is_read & (off > _OFF_M)).sum() / readings
        found[n, 0] = _similarity(colour, samples[:count], off, foreground_m, appearance, table)
        middle = samples[:count][is_read & (samples[:count, 3] > 0.0) & (np.abs(off) < foreground_m)]
        if found[n, 0] > 0.0 and len(middle):
            x = ((middle[:, 0] - camera[1]) / camera[0] * middle[:, 2]).mean()
            found[n, 1] = _miss(rotation, origin, places[n], x, middle[:, 2].mean() + body[3])
    return found


@njit(cache=True, nogil=True)
def _sample(depth: Depth, left: float, top: float, width: float, height: float, samples: Floats) -> int:
    """Write u, v, reading [m] and whether it is in the middle (N, 4) for a grid in a box; return N."""
    count = 0
    for row in range(ROWS):
        v = int(top + (row + 0.5) / ROWS * height + 0.5)
        if v < 0 or v >= depth.shape[0]:
            continue
        for column in range(COLUMNS):
            u = int(left + (column + 0.5) / COLUMNS * width + 0.5)
            if 0 <= u < depth.shape[1]:
                is_middle = _MIDDLE[0] <= column < _MIDDLE[1] and _MIDDLE[2] <= row < _MIDDLE[3]
                samples[count, 0], samples[count, 1] = u, v
                samples[count, 2], samples[count, 3] = depth[v, u] / 1000.0, is_middle
                count += 1
    return count


@njit(cache=True, nogil=True)
def _similarity(
    colour: Image,
    samples: Floats,
    off: Floats,
    foreground_m: float,
    appearance: Floats,
    table: NDArray[np.uint8],
) -> float:
    """Return the similarity of colours of samples at the right depth; 0 for too few (SA eq. 4.25)."""
    counts, total = np.zeros(BINS), 0
    for k in range(len(samples)):
        if math.isinf(foreground_m) or (samples[k, 2] > 0.0 and abs(off[k]) < foreground_m):
            total += 1
            counts[bin_at(colour, int(samples[k, 1]), int(samples[k, 0]), table)] += 1.0
    if total < _LEAST_SAMPLES:
        return 0.0
    similar = 0.0
    for k in range(BINS):
        similar += math.sqrt(appearance[k] * counts[k] / total)
    return similar


@njit(cache=True, nogil=True)
def _miss(rotation: Floats, origin: Floats, place: Floats, x: float, z: float) -> float:
    """Return the distance [m] on the floor between a position and a point of the optical frame."""
    across = rotation[0, 0] * x + rotation[0, 2] * z + origin[0] - place[0]
    aside = rotation[1, 0] * x + rotation[1, 2] * z + origin[1] - place[1]
    return math.hypot(across, aside)


@njit(cache=True, nogil=True)
def _readings_in(
    depth: Depth, colour: Image, box: Floats, table: NDArray[np.uint8]
) -> tuple[Floats, NDArray[np.int64]]:
    """Return depths [m], 0 for none, and colour bins of a grid of pixels in a box, both (rows, columns)."""
    readings = np.zeros((2 * ROWS, 2 * COLUMNS))
    bins = np.zeros((2 * ROWS, 2 * COLUMNS), np.int64)
    for row in range(2 * ROWS):
        v = int(box[1] + (row + 0.5) / (2 * ROWS) * box[3])
        for column in range(2 * COLUMNS):
            u = int(box[0] + (column + 0.5) / (2 * COLUMNS) * box[2])
            if 0 <= v < depth.shape[0] and 0 <= u < depth.shape[1] and depth[v, u] > 0:
                readings[row, column] = depth[v, u] / 1000.0
                bins[row, column] = bin_at(colour, v, u, table)
    return readings, bins


@njit(cache=True, nogil=True)
def _between_two(readings: Floats) -> float:
    """Split readings [m] into two clusters by their means; return the limit between them (SA 4.4.2)."""
    near, far = float(readings.min()), float(readings.max())
    for _ in range(10):
        limit = 0.5 * (near + far)
        is_near = readings <= limit
        if is_near.all():
            break
        near, far = readings[is_near].mean(), readings[~is_near].mean()
    return 0.5 * (near + far)
