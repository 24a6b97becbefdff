"""What a pixel has looked like without people: a background that goes along with the robot."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.panoramic.foreground.floor_rows import STEP_M, FloorRows

Linear = NDArray[np.float32]

CHANNELS: Final = 6
VARIANCE, AGE, DOUBT = 3, 4, 5
"""Channels of a memory after red, green and blue [grey levels]: their variance [grey levels squared], for how
long it has been seen [s], and by how many columns it may lie wrong if it is no floor [px]."""

FIRST_VARIANCE: Final = 16.0
LEAST_VARIANCE: Final = 2.0
_TAU_S: Final = 2.0  # a background that is seen adapts within this time,
_VARIANCE_TAU_S: Final = 8.0
_ABSORB_TAU_S: Final = 40.0  # and one that people seem to hide within this.


def first_memory(image: NDArray[np.uint8]) -> Linear:
    """Begin with an RGB image (H, W, 3), which may show people: (H, W, 6) memory of age 0."""
    memory = np.zeros((*image.shape[:2], CHANNELS), np.float32)
    memory[..., :VARIANCE] = image
    memory[..., VARIANCE] = FIRST_VARIANCE
    return memory


def move_along(memory: Linear, odometry: Odometry, floor: FloorRows) -> Linear:
    """Bring a memory (H, W, 6) to where the robot is now, as if all it shows were floor.

    What was not in the image before has age 0. Turning shifts columns, whatever they show.
    """
    return _moved(
        memory, odometry.advance_m, odometry.aside_m, odometry.turn_rad, floor.distance_m, floor.row_at
    )


@njit(cache=True, fastmath=True)
def _moved(
    memory: Linear, advance: float, aside: float, turn: float, distance: Linear, row_at: Linear
) -> Linear:
    height, width, _ = memory.shape
    moved = np.empty_like(memory)
    way = math.hypot(advance, aside)
    per_rad = width / (2.0 * math.pi)
    shift = -turn * per_rad
    angle = math.pi - (np.arange(width) + 0.5) / per_rad + turn
    along = advance * np.cos(angle) + aside * np.sin(angle)
    across = aside * np.cos(angle) - advance * np.sin(angle)
    for v in range(height):
        for u in range(width):
            off, row = np.float32(shift), np.float32(v)
            if way > 0.0:
                out = distance[v] + along[u]
                slope = across[u] / max(out, 0.1)
                off = np.float32(shift - per_rad * (slope - slope * slope * slope / 3.0))  # of the arctangent
                at = min(math.sqrt(out * out + across[u] * across[u]) / STEP_M, len(row_at) - 1.001)
                k = int(at)
                row = row_at[k] + np.float32(at - k) * (row_at[k + 1] - row_at[k])
            is_seen = -0.5 <= row <= height - 0.5
            row = min(max(row, np.float32(0.0)), np.float32(height - 1))
            left, top = math.floor(off), int(row)
            right_share, low_share = off - np.float32(left), row - np.float32(top)
            low = min(top + 1, height - 1)
            a = (u + int(left)) % width
            b = a + 1 if a + 1 < width else 0
            for c in range(CHANNELS):
                upper = memory[top, a, c] + right_share * (memory[top, b, c] - memory[top, a, c])
                lower = memory[low, a, c] + right_share * (memory[low, b, c] - memory[low, a, c])
                moved[v, u, c] = upper + low_share * (lower - upper)
            moved[v, u, DOUBT] += way / distance[v] * per_rad
            if not is_seen:
                moved[v, u, AGE] = 0.0
    return moved


@njit(cache=True, fastmath=True)
def compare(image: NDArray[np.uint8], memory: Linear, block: int) -> Linear:
    """Tell of each pixel of an image (H, W, 3) what it looks like, and how its memory does.

    These are its colour, by how many standard deviations it differs from the memory (their logarithm), and
    the memory's age and doubt. To a pixel's own variance is added what its background's slope makes of a
    third of a pixel. Its doubt does not widen that: floor lies right, and whether it is floor the network
    tells.

    Returns:
        (block * block * 6, H / block, W / block) the features by squares of pixels, a square's row by row.
    """
    height, width, _ = image.shape
    told = np.empty((block, block, 6, height // block, width // block), np.float32)
    for v in range(height):
        above, below = max(v - 1, 0), min(v + 1, height - 1)
        for u in range(width):
            left, right = u - 1 if u > 0 else width - 1, u + 1 if u < width - 1 else 0
            square, steep = np.float32(0.0), np.float32(0.0)
            pixel = told[v % block, u % block, :, v // block, u // block]
            for c in range(3):
                seen = np.float32(image[v, u, c])
                pixel[c] = (seen - np.float32(128.0)) / np.float32(64.0)
                off = seen - memory[v, u, c]
                square += off * off
                across = memory[v, right, c] - memory[v, left, c]
                along = memory[below, u, c] - memory[above, u, c]
                steep += across * across + along * along
            age, doubt = memory[v, u, AGE], memory[v, u, DOUBT]
            spread = np.float32(3.0) * memory[v, u, VARIANCE] + np.float32(0.025) * steep
            pixel[3] = np.float32(0.5) * np.log(np.float32(1.0) + square / spread)
            pixel[4] = age / (np.float32(1.0) + age)
            pixel[5] = doubt / (np.float32(1.0) + doubt)
    return told.reshape(block * block * 6, height // block, width // block)


@njit(cache=True)
def novelty(squares: Linear) -> Linear:
    """Tell by the features that `compare` gives how unlike its background each pixel (H, W) is, 0..1.

    It is 0 within two standard deviations, and 1 from eight on, or less where the background is young.
    """
    block = round(math.sqrt(squares.shape[0] // 6))
    _, rows, columns = squares.shape
    told = np.empty((rows * block, columns * block), np.float32)
    low, high = np.float32(0.8), np.float32(2.1)
    for v in range(rows * block):
        for u in range(columns * block):
            first = ((v % block) * block + u % block) * 6
            unlike, age = squares[first + 3 : first + 5, v // block, u // block]
            told[v, u] = age * min(max((unlike - low) / (high - low), np.float32(0.0)), np.float32(1.0))
    return told


@njit(cache=True, fastmath=True)
def learn(memory: Linear, image: NDArray[np.uint8], foreground: Linear, passed_s: float) -> None:
    """Let a memory take in an image, the less the likelier a pixel is a person (H, W).

    Time is in seconds, so that the rate of images does not matter. What is new is taken over at once, and
    a mean over all that was seen as long as it is younger than the time in which it adapts.
    """
    height, width, _ = image.shape
    absorbed = 1.0 - math.exp(-passed_s / _ABSORB_TAU_S)
    for v in range(height):
        for u in range(width):
            clear = (1.0 - foreground[v, u]) ** 4
            age = memory[v, u, AGE]
            rate = max(passed_s / (age + passed_s), 1.0 - math.exp(-passed_s / _TAU_S))
            if age > 0.0:
                rate = clear * rate + (1.0 - clear) * absorbed
            square = 0.0
            for c in range(3):
                off = image[v, u, c] - memory[v, u, c]
                square += off * off
                memory[v, u, c] += np.float32(rate * off)
            slowly = clear * min(rate, max(passed_s / (age + 1.0), passed_s / _VARIANCE_TAU_S))
            variance = memory[v, u, VARIANCE] + slowly * (square / 3.0 - memory[v, u, VARIANCE])
            memory[v, u, VARIANCE] = max(variance, np.float32(LEAST_VARIANCE))
            memory[v, u, AGE] = min(age + clear * passed_s, np.float32(60.0))
            memory[v, u, DOUBT] *= np.float32(1.0 - rate)
