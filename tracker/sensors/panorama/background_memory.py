"""Background model of the panorama: the appearance of each pixel without people, moving with the robot."""

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import logarithm
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.networks.mask_network import BLOCK
from peopleboy.tracker.sensors.panorama.floor_rows import FARTHEST_M, FloorRows

Linear = NDArray[np.float32]
Pair = tuple[float, float]
Triple = tuple[float, float, float]

CHANNELS: Final = 6
VARIANCE, AGE, DOUBT = 3, 4, 5
"""Planes after red, green and blue [grey levels]: their variance [grey levels squared], the age [s], and the
possible displacement in columns of surfaces other than the floor [px]."""

FIRST_VARIANCE: Final = 16.0
LEAST_VARIANCE: Final = 2.0
_TAU_S: Final = 2.0  # time constant of the background where it is visible,
_VARIANCE_TAU_S: Final = 8.0
_ABSORB_TAU_S: Final = 40.0  # and where people seem to occlude it.
_OLDEST_S: Final = 60.0
_WALLS_M: Final = 4.0  # usual distance of what is above the horizon
_UNLIKE_FROM, _UNLIKE_TO = 0.8, 2.1  # two standard deviations, and eight


def first_memory(image: NDArray[np.uint8]) -> Linear:
    """Make the memory (6, H, W) from an RGB image (H, W, 3), which may show people; its age is 0."""
    memory = np.zeros((CHANNELS, *image.shape[:2]), np.float32)
    memory[:VARIANCE] = image.transpose(2, 0, 1)
    memory[VARIANCE] = FIRST_VARIANCE
    return memory


def move_along(memory: Linear, odometry: Odometry, floor: FloorRows) -> Linear:
    """Warp a memory (6, H, W) by the robot's motion, as if all surfaces were floor.

    Areas that were outside the image get age 0. A rotation shifts columns of all surfaces alike. Surfaces
    above the horizon are not floor, and only rotate.
    """
    way, row = (odometry.advance_m, odometry.aside_m), (floor.horizon, floor.slope, floor.offset_m)
    return _moved(memory, way, odometry.turn_rad, floor.distance_m, row)


@njit(cache=True, fastmath=True, error_model="numpy")
def _moved(memory: Linear, by_m: Pair, turn: float, distance: Linear, row_of: Triple) -> Linear:
    _, height, width = memory.shape
    advance, aside = by_m
    moved = np.empty_like(memory)
    way = math.hypot(advance, aside)
    per_rad = width / math.tau
    angle = math.pi - (np.arange(width) + 0.5) / per_rad + turn
    along = (advance * np.cos(angle) + aside * np.sin(angle)).astype(np.float32)
    across = (aside * np.cos(angle) - advance * np.sin(angle)).astype(np.float32)
    columns, rows = np.empty(width, np.float32), np.empty(width, np.float32)
    corners, shares = np.empty((4, width), np.uint32), np.empty((2, width), np.float32)
    for v in range(height):
        columns[:], rows[:] = np.float32(-turn * per_rad), np.float32(v)
        is_floor = distance[v] < FARTHEST_M
        if way > 0.0 and is_floor:
            _look_up(columns, rows, distance[v], along, across, row_of)
        _find(columns, rows, height, corners, shares)
        _interpolate(memory, corners, shares, moved, v)
        doubt, age = moved[DOUBT, v], moved[AGE, v]
        more = np.float32(way / (distance[v] if is_floor else np.float32(_WALLS_M)) * per_rad)
        for u in range(width):
            doubt[u] += more
            if rows[u] < np.float32(-0.5) or rows[u] > np.float32(height - 0.5):
                age[u] = np.float32(0.0)
    return moved


@njit(cache=True, fastmath=True, error_model="numpy")
def _look_up(
    columns: Linear, rows: Linear, distance: np.float32, along: Linear, across: Linear, row_of: Triple
) -> None:
    """Return the column shifts (W,) of the floor in a row, and the source rows (W,)."""
    per_rad = np.float32(len(columns) / math.tau)
    a, b, c = np.float32(row_of[0]), np.float32(row_of[1]), np.float32(row_of[2])
    for u in range(len(columns)):
        out = distance + along[u]
        slope = across[u] / max(out, np.float32(0.1))
        columns[u] -= per_rad * (slope - slope * slope * slope * np.float32(1.0 / 3.0))  # of the arctangent
        away = math.sqrt(out * out + across[u] * across[u])
        rows[u] = (a * away + b) / (away + c)


@njit(cache=True, fastmath=True, error_model="numpy")
def _find(columns: Linear, rows: Linear, height: int, corners: NDArray[np.uint32], shares: Linear) -> None:
    """Return the four neighbouring pixels (4, W) of positions in a plane, and the fractions (2, W)."""
    width = len(columns)
    wide, bottom = np.float32(width), np.float32(height - 1)
    for u in range(width):
        left = np.floor(columns[u])
        row = min(max(rows[u], np.float32(0.0)), bottom)
        shares[0, u], shares[1, u] = columns[u] - left, row - np.floor(row)
        a = np.int32(left - wide * np.floor(left / wide)) + np.int32(u)
        a = a - width if a >= width else a
        b = a + 1 if a + 1 < width else 0
        top = np.int32(row) * width
        low = top + width if top + width < height * width else top
        corners[0, u], corners[1, u] = np.uint32(top + a), np.uint32(top + b)
        corners[2, u], corners[3, u] = np.uint32(low + a), np.uint32(low + b)


@njit(cache=True, fastmath=True, error_model="numpy")
def _interpolate(memory: Linear, corners: NDArray[np.uint32], shares: Linear, moved: Linear, v: int) -> None:
    """Interpolate all planes between pixels into line v."""
    top_left, top_right, low_left, low_right = corners[0], corners[1], corners[2], corners[3]
    right, low = shares[0], shares[1]
    flat, plane = memory.reshape(-1), np.uint64(memory.shape[1] * memory.shape[2])
    for u in range(len(right)):
        i, j = np.uint64(top_left[u]), np.uint64(top_right[u])
        k, l = np.uint64(low_left[u]), np.uint64(low_right[u])  # noqa: E741
        for channel in range(CHANNELS):
            a, b, c, d = flat[i], flat[j], flat[k], flat[l]
            upper = a + right[u] * (b - a)
            moved[channel, v, u] = upper + low[u] * (c + right[u] * (d - c) - upper)
            i, j, k, l = i + plane, j + plane, k + plane, l + plane  # noqa: E741


@njit(cache=True, fastmath=True, error_model="numpy")
def compare(image: NDArray[np.uint8], memory: Linear) -> tuple[Linear, Linear]:
    """Return features of each pixel of an image (H, W, 3) and of its memory.

    They are its colour, its difference from the memory in standard deviations (logarithm), and the memory's
    age and doubt. The pixel's variance includes the effect of the background's gradient over a third of a
    pixel. The doubt is not included: floor is aligned, and the network decides whether it is floor.

    Returns:
        squares: (BLOCK * BLOCK * 6, H / BLOCK, W / BLOCK) features by squares of pixels, row by row within a
            square.
        novelty: (H, W) difference of each pixel from the background, 0..1. It is 0 within two standard
            deviations, and 1 from eight on, or less where the background is young.
    """
    _, height, width = memory.shape
    squares = np.empty((BLOCK * BLOCK * CHANNELS, height // BLOCK, width // BLOCK), np.float32)
    novelty = np.empty((height, width), np.float32)
    colours, features = np.empty((3, width), np.float32), np.empty((CHANNELS, width), np.float32)
    ring, square, steep = (
        np.empty(width + 2, np.float32),
        np.empty(width, np.float32),
        np.empty(width, np.float32),
    )
    for v in range(height):
        _split(image[v], colours)
        square[:], steep[:] = np.float32(0.0), np.float32(0.0)
        for c in range(3):
            _close(memory[c, v], ring)
            above, below = memory[c, max(v - 1, 0)], memory[c, min(v + 1, height - 1)]
            _differ(colours[c], ring, above, below, square, steep, features[c])
        _judge(memory, v, square, steep, features[3:], novelty[v])
        _cut(features, v, squares)
    return squares, novelty


@njit(cache=True, fastmath=True)
def _split(line: NDArray[np.uint8], colours: Linear) -> None:
    """Separate a line of pixels (W, 3) by colours (3, W)."""
    red, green, blue = colours[0], colours[1], colours[2]
    pixels, one = line.reshape(-1), np.uint64(1)
    for u in range(np.uint64(len(line))):
        at = np.uint64(3) * u
        red[u], green[u], blue[u] = pixels[at], pixels[at + one], pixels[at + one + one]


@njit(cache=True, fastmath=False)
def _close(line: Linear, ring: Linear) -> None:
    """Copy a line (W,) with one pixel beyond each end (W + 2,)."""
    width = len(line)
    ring[0], ring[width + 1] = line[width - 1], line[0]
    for u in range(width):
        ring[u + 1] = line[u]


@njit(cache=True, fastmath=True)
def _cut(features: Linear, v: int, squares: Linear) -> None:
    """Write features (6, W) of line v into squares."""
    for channel in range(CHANNELS):
        feature = features[channel]
        first, row = v % BLOCK * BLOCK * CHANNELS + channel, v // BLOCK
        told0, told1 = squares[first, row], squares[first + CHANNELS, row]
        told2, told3 = squares[first + 2 * CHANNELS, row], squares[first + 3 * CHANNELS, row]
        for u in range(np.uint64(len(told0))):
            at = np.uint64(BLOCK) * u
            told0[u], told1[u] = feature[at], feature[at + np.uint64(1)]
            told2[u], told3[u] = feature[at + np.uint64(2)], feature[at + np.uint64(3)]


@njit(cache=True, fastmath=True)
def _differ(
    seen: Linear, ring: Linear, above: Linear, below: Linear, square: Linear, steep: Linear, feature: Linear
) -> None:
    """Sum the differences of a line's colour (W,) from the memory's (W + 2,), and its gradients."""
    left, middle, right = ring[:-2], ring[1:-1], ring[2:]
    for u in range(len(seen)):
        off = seen[u] - middle[u]
        square[u] += off * off
        over, along = right[u] - left[u], below[u] - above[u]
        steep[u] += over * over + along * along
        feature[u] = (seen[u] - np.float32(128.0)) / np.float32(64.0)


@njit(cache=True, fastmath=True, error_model="numpy")
def _judge(memory: Linear, v: int, square: Linear, steep: Linear, features: Linear, novelty: Linear) -> None:
    """Convert the differences of line v to three features and the novelty, by the memory's variance."""
    variance, age, doubt = memory[VARIANCE, v], memory[AGE, v], memory[DOUBT, v]
    off, old, doubtful = features[0], features[1], features[2]
    one, low, wide = np.float32(1.0), np.float32(_UNLIKE_FROM), np.float32(_UNLIKE_TO - _UNLIKE_FROM)
    for u in range(len(square)):
        spread = np.float32(3.0) * variance[u] + np.float32(0.025) * steep[u]
        unlike, share = np.float32(0.5) * logarithm(one + square[u] / spread), age[u] / (one + age[u])
        off[u], old[u], doubtful[u] = unlike, share, doubt[u] / (one + doubt[u])
        novelty[u] = share * min(max((unlike - low) / wide, np.float32(0.0)), one)


@njit(cache=True, fastmath=True)
def learn(memory: Linear, image: NDArray[np.uint8], foreground: Linear, passed_s: float) -> None:
    """Update the memory with an image, less where pixels are likely people (H, W).

    Rates are per second, so that the frame rate does not matter. New areas are copied at once, and young ones
    hold the mean of all images so far.
    """
    _, height, width = memory.shape
    colours = np.empty((3, width), np.float32)
    clear, rate = np.empty(width, np.float32), np.empty(width, np.float32)
    square = np.empty(width, np.float32)
    for v in range(height):
        _split(image[v], colours)
        _set_rates(foreground[v], memory[AGE, v], np.float32(passed_s), clear, rate)
        square[:] = np.float32(0.0)
        for c in range(3):
            _approach(memory[c, v], colours[c], rate, square)
        _grow_old(memory, v, square, clear, rate, np.float32(passed_s))


@njit(cache=True, fastmath=True, error_model="numpy")
def _set_rates(foreground: Linear, age: Linear, passed_s: np.float32, clear: Linear, rate: Linear) -> None:
    """Return the probabilities that a line's pixels are background, and their update rates."""
    one = np.float32(1.0)
    absorbed = np.float32(1.0 - math.exp(-passed_s / _ABSORB_TAU_S))
    least = np.float32(1.0 - math.exp(-passed_s / _TAU_S))
    for u in range(len(age)):
        free = (one - foreground[u]) * (one - foreground[u])
        clear[u] = free = free * free
        share = max(passed_s / (age[u] + passed_s), least)
        rate[u] = free * share + (one - free) * absorbed if age[u] > np.float32(0.0) else share


@njit(cache=True, fastmath=True)
def _approach(known: Linear, seen: Linear, rate: Linear, square: Linear) -> None:
    """Update a line's colour, and sum the squared differences."""
    for u in range(len(known)):
        off = seen[u] - known[u]
        square[u] += off * off
        known[u] += rate[u] * off


@njit(cache=True, fastmath=True, error_model="numpy")
def _grow_old(
    memory: Linear, v: int, square: Linear, clear: Linear, rate: Linear, passed_s: np.float32
) -> None:
    """Update variance, age and doubt of line v."""
    variance, age, doubt = memory[VARIANCE, v], memory[AGE, v], memory[DOUBT, v]
    one, steady = np.float32(1.0), np.float32(passed_s / _VARIANCE_TAU_S)
    least, oldest = np.float32(LEAST_VARIANCE), np.float32(_OLDEST_S)
    for u in range(len(square)):
        slowly = clear[u] * min(rate[u], max(passed_s / (age[u] + one), steady))
        now = variance[u] + slowly * (square[u] * np.float32(1.0 / 3.0) - variance[u])
        variance[u] = max(now, least)
        age[u] = min(age[u] + clear[u] * passed_s, oldest)
        doubt[u] *= one - rate[u]
