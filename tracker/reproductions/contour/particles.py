"""Weighted samples of one person's contour: initialisation, motion, resampling and estimation."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import exponential, exponentials
from peopleboy.tracker.reproductions.contour.contour_config import (
    REFERENCE_HEIGHT_PX,
    FilterConfig,
    LimitsConfig,
    MotionConfig,
    TrackerConfig,
)
from peopleboy.tracker.reproductions.contour.weights import scale_to_one, systematic_rows

X: Final = 0
Y: Final = 1
W: Final = 2
H: Final = 3
D: Final = 4
VX: Final = 5
VY: Final = 6
VW: Final = 7
VH: Final = 8
STATE_SIZE: Final = 9
# Proportions of standing people in body semi-heights. The thesis divides h "by a constant factor" for the
# head, too, but does not print it (section 4.2): 4.4 is our reading.
HEAD_DIVISOR: Final = 4.4  # body semi-height / head semi-height
CROWN: Final = 1 + 2 / HEAD_DIVISOR  # top of the head above the body's centre
FOOT: Final = 2.05  # feet below it

RESIZING = 0.3  # standard deviation of the logarithm of the size of resized samples
BOX_SPREAD = 0.05  # of a person within a known box, as a share of its sides

Floats = NDArray[np.float32]
Ends = tuple[float, float]
CameraTurn = tuple[float, float, float]
"""Tangent of the angle by which a camera turned to the left; focal length and middle column [px]."""


@dataclass(frozen=True, slots=True, eq=False)
class Particles:
    """N weighted hypotheses of one person's contour in the thermal image.

    Image frame: u right, v down, origin at the centre of the top-left pixel. Both arrays become read-only.

    Attributes:
        state: (N, 9) float32 [px, px/s] columns X, Y, W, H, D, VX, VY, VW, VH.
        weight: (N,) float32, non-negative, sums to 1.
    """

    state: Floats
    weight: Floats

    def __post_init__(self) -> None:
        self.state.setflags(write=False)
        self.weight.setflags(write=False)

    def __len__(self) -> int:
        return len(self.weight)


def draw_prior(
    count: int,
    shape: tuple[int, int],
    motion: MotionConfig,
    filter_config: FilterConfig,
    rng: np.random.Generator,
) -> Floats:
    """Draw samples (count, 9) uniformly within the limits; velocities are normal with mean 0.

    Source: thesis, section 4.1, "in our case uniform".
    """
    height, width = shape
    limits, is_log_uniform = filter_config.limits, filter_config.log_uniform_h
    chance = rng.random((count, 5), dtype=np.float32)
    velocity = rng.standard_normal((count, 4), dtype=np.float32)
    noise = (motion.noise_x, motion.noise_y, motion.noise_w, motion.noise_h)
    amplitude = np.array(noise if motion.fresh_speed is None else motion.fresh_speed, dtype=np.float32)
    speed = height / REFERENCE_HEIGHT_PX * amplitude
    sizes = (math.log(limits.h[0]), math.log(limits.h[1])) if is_log_uniform else limits.h
    state: Floats = _laid_out(
        chance, velocity, width, height, sizes, is_log_uniform, limits.ratio_wh, limits.ratio_dw,
        limits_px(height, limits), speed,
    )  # fmt: skip
    return state


def limits_px(height: int, limits: LimitsConfig) -> Floats:
    """Return limits as an array for kernels, for images of a height in rows: (15,).

    Ends of w / h, d / w, y and h [px]; then, for `floor_rows`, the row of the horizon, the two limits below
    it, the three terms of the variance, and the rows.
    """
    ends = (limits.ratio_wh, limits.ratio_dw, limits.y, limits.h)
    return _limits_px(height, ends, limits.horizon, limits.y_below_horizon, limits.floor_variance)


@lru_cache(maxsize=16)
def _limits_px(
    height: int,
    ends: tuple[Ends, Ends, Ends, Ends],
    horizon: float,
    y_below_horizon: Ends,
    variance: tuple[float, float, float],
) -> Floats:
    ratio_wh, ratio_dw, y, h = ends
    in_px = (height * end for end in (*y, *h))
    laid_out = np.array(
        (*ratio_wh, *ratio_dw, *in_px, horizon * height, *y_below_horizon, *variance, height), np.float32
    )
    laid_out.setflags(write=False)
    return laid_out


@njit(cache=True, nogil=True, error_model="numpy")
def floor_rows(h: np.float32, limits: Floats) -> tuple[np.float32, np.float32]:
    """Return the limits [px] of the row of the centre of a person of semi-height h on the floor.

    The limits are those of `limits_px`.
    """
    horizon, rows = limits[8], limits[14]
    low, high = horizon + limits[9] * h, horizon + limits[10] * h
    if limits[11] != 0 or limits[12] != 0 or limits[13] != 0:
        size = h / rows
        variance = limits[11] + size * (limits[12] + size * limits[13])
        more = rows * np.sqrt(max(variance, np.float32(0)))
        low, high = low - more, high + more
    return low, high


@njit(cache=True, nogil=True, error_model="numpy")
def _laid_out(
    chance: Floats,
    velocity: Floats,
    width: int,
    height: int,
    sizes: Ends,
    is_log_uniform: bool,
    ratio_wh: Ends,
    ratio_dw: Ends,
    limits: Floats,
    speed: Floats,
) -> Floats:
    """Map random numbers (N, 5) for position and size, and (N, 4) for the velocities, to samples (N, 9).

    Log-uniform: small and far people are as frequent as large and near ones. `limits_px` gives the limits of
    y and of the floor.
    """
    state, wide, tall = np.empty((len(chance), STATE_SIZE), np.float32), np.float32(width), np.float32(height)
    for i in range(len(chance)):
        size = _between(sizes, chance[i, 2])
        h = tall * (exponential(size) if is_log_uniform else size)
        above, below = floor_rows(h, limits)
        low, high = max(limits[4], above), min(limits[5], below)
        w = h * _between(ratio_wh, chance[i, 3])
        state[i, X], state[i, Y] = wide * chance[i, 0], low + (high - low) * chance[i, 1]
        state[i, W], state[i, H], state[i, D] = w, h, w * _between(ratio_dw, chance[i, 4])
        for k in range(4):
            state[i, VX + k] = speed[k] * velocity[i, k]
    return state


@njit(cache=True, nogil=True)
def _between(ends: Ends, chance: np.float32) -> np.float32:
    return np.float32(ends[0]) + np.float32(ends[1] - ends[0]) * chance


def draw_around(
    box: tuple[float, float, float, float], config: TrackerConfig, rng: np.random.Generator
) -> Floats:
    """Draw samples (N, 9) of a standing person with a known box [px].

    The box gives top, height and column; its width may include arms and a stride, so that the body's width is
    drawn from the limits.
    """
    left, top, width, height = box
    limits, count = config.person.limits, config.person.count
    spread = exponentials((BOX_SPREAD * rng.standard_normal(count)).astype(np.float32))
    h = height / config.box.height_per_h * spread
    state = np.zeros((count, STATE_SIZE), dtype=np.float32)
    state[:, H] = h
    state[:, X] = left + width / 2 + BOX_SPREAD * width * rng.standard_normal(count)
    state[:, Y] = top + (CROWN + config.box.hair_per_h) * h
    state[:, W] = h * rng.uniform(*limits.ratio_wh, count)
    state[:, D] = state[:, W] * rng.uniform(*limits.ratio_dw, count)
    return state


def camera_turn(turn_rad: float, focal_px: float, centre_px: float) -> CameraTurn:
    """Return a rotation of the camera to the left [rad] in terms of image columns."""
    return math.tan(turn_rad), focal_px, centre_px


def turned(x: float, turn: CameraTurn) -> float:
    """Return the new column of a column x [px] after a rotation of the camera: a left turn shifts it right.

    The thesis leaves the robot's motion to the noise, but its rotation is known from odometry.
    """
    along, focal_px, centre_px = turn
    slope = (x - centre_px) / focal_px
    return centre_px + focal_px * (slope + along) / (1.0 - slope * along)


def predict(
    state: Floats,
    rows: NDArray[np.int64],
    dt_s: float,
    turn: CameraTurn,
    size: float,
    config: MotionConfig,
    rng: np.random.Generator,
    resized_share: float = 0.0,
) -> Floats:
    """Predict some of the samples by one time step, (N, 9).

    Constant velocity in (x, y, w, h), a random walk in d and in the velocities; then the camera turns. A
    share is resized, alternately about the top of the head and about the feet, so that a torso taken for a
    whole person is corrected.

    Args:
        state: (M, 9) current samples.
        rows: (N,) selected samples.
        dt_s: time step [s].
        turn: of the camera.
        size: image height / 240; the amplitudes are given for an image of 240 rows.
        config: amplitudes of the random walk.
        rng: random generator.
        resized_share: share of resized samples.

    Source: thesis, equations 4.7 and 4.8.
    """
    amplitude = noise_per_step(dt_s, size, config)
    memory = _scaled(1.0, (config.place_memory, config.place_memory, config.size_memory, config.size_memory))
    noise = rng.standard_normal((len(rows), 5), dtype=np.float32)
    moved: Floats = _predicted(
        state, rows, noise, amplitude, memory, dt_s, size * config.noise_by_height, turn
    )
    if resized_share > 0:
        apart = round(1 / resized_share)
        _resize(moved, apart, rng.standard_normal(-(-len(moved) // apart), dtype=np.float32))
    return moved


def noise_per_step(dt_s: float, size: float, config: MotionConfig) -> Floats:
    """Return the amplitudes (5,) of the random walk in d, vx, vy, vw, vh over one step, the end of B.

    The sources give amplitudes per second: the velocities' entries are multiplied by dt through A, so d's
    entry is multiplied by dt here.
    """
    a_second = config.noise_x, config.noise_y, config.noise_w, config.noise_h
    return _scaled(size, (config.noise_d * dt_s, *a_second))


@lru_cache(maxsize=64)
def _scaled(factor: float, numbers: tuple[float, ...]) -> Floats:
    """Return values as an array for kernels, multiplied by a factor."""
    scaled = (factor * np.array(numbers)).astype(np.float32)
    scaled.setflags(write=False)
    return scaled


def equally_weighted(state: Floats) -> Particles:
    """Return the (N, 9) states with equal weights 1/N."""
    return Particles(state, np.full(len(state), 1 / len(state), dtype=np.float32))


def normalised(weight: Floats) -> Floats:
    """Normalise (N,) non-negative weights to sum to 1; equal weights where none is positive."""
    scaled = weight.astype(np.float32)
    scale_to_one(scaled)
    return scaled


def resample(particles: Particles, count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw the rows (count,) of the resampled samples by systematic resampling.

    Row i appears floor(count w_i) or ceil(count w_i) times; the whole draw uses one random number.

    Source: thesis, algorithm 4.
    """
    rows: NDArray[np.int64] = systematic_rows(particles.weight, count, rng.random())
    return rows


def mean_state(particles: Particles) -> NDArray[np.float64]:
    """Return the (9,) weighted mean state.

    Source: thesis, equation 4.2; its extra 1/N is a slip once the weights are normalised.
    """
    mean: NDArray[np.float64] = _mean(particles.state, particles.weight)
    return mean


def uncertainty_px2(particles: Particles) -> float:
    """Return the weighted squared distance of the particles from their mean, over x and y [px^2].

    Source: thesis, equation 4.6; read over the position alone, since the sources' threshold of 400 counts
    pixels.
    """
    return float(_spread(particles.state, particles.weight, _mean(particles.state, particles.weight)))


@njit(cache=True, nogil=True, error_model="numpy")
def estimated(
    state: Floats,
    weight: Floats,
    chance: Floats,
    is_inside: NDArray[np.bool_],
    choice: tuple[float, float],
) -> tuple[Floats, Floats, NDArray[np.float64], float, float]:
    """Select the samples (N, 9) that form the estimate: of the best ones, those near the best.

    With several people in view the mean over all particles lies between them (thesis, figure 4.5); the mean
    over those near the best lies on one of them.

    Args:
        state: (N, 9) samples.
        weight: (N,) of the samples.
        chance: (N,) probability of a person, by the image.
        is_inside: (N,) whether they are within the limits; others have probability 0.
        choice: selected share of N, rounded up, of the highest weights, including ties (paper: the best 30
            %); and their greatest distance from the best, in its semi-axes.

    Returns:
        state: (K, 9) of the selected samples.
        weight: (K,) that sum to 1.
        mean: (9,) state.
        confidence: their mean probability.
        spread: as defined by `uncertainty_px2` [px^2].
    """
    share, reach = choice
    others = len(weight) - math.ceil(share * len(weight))
    # Weight of the last selected sample: ties are included, so that the sorting order does not matter.
    least = np.partition(weight, others)[others]
    rows = _rows_near_best(state, weight, least, np.float32(reach * reach))
    core, heavy = np.empty((len(rows), STATE_SIZE), np.float32), np.empty(len(rows), np.float32)
    for i in range(np.uint64(len(rows))):
        for k in range(np.uint64(STATE_SIZE)):
            core[i, k] = state[rows[i], k]
        heavy[i] = weight[rows[i]]
    scale_to_one(heavy)
    confidence = 0.0
    for i in range(np.uint64(len(rows))):
        sure = chance[rows[i]] if is_inside[rows[i]] else np.float32(0)
        confidence += heavy[i] * np.float64(sure)
    mean = _mean(core, heavy)
    return core, heavy, mean, confidence, _spread(core, heavy, mean)


@njit(cache=True, nogil=True)
def _resize(state: Floats, apart: int, chance: Floats) -> None:
    """Resize every n-th of samples (N, 9) by normal random numbers (M,), in place, as `predict` says."""
    for k in range(np.uint64(len(chance))):
        i, factor = k * np.uint64(apart), exponential(np.float32(RESIZING) * chance[k])
        kept = np.float32(-CROWN) if k % 2 == 0 else np.float32(FOOT)
        state[i, Y] -= kept * (factor - np.float32(1)) * state[i, H]
        state[i, W] *= factor
        state[i, H] *= factor


@njit(cache=True, nogil=True, error_model="numpy")
def _predicted(
    state: Floats,
    rows: NDArray[np.int64],
    noise: Floats,
    amplitude: Floats,
    memory: Floats,
    dt_s: float,
    by_height: float,
    turn: CameraTurn,
) -> Floats:
    result = np.empty((len(rows), STATE_SIZE), dtype=np.float32)
    along, focal, centre = np.float32(turn[0]), np.float32(turn[1]), np.float32(turn[2])
    for i in range(np.uint64(len(rows))):
        row = np.uint64(rows[i])
        # by_height is the semi-height to which the amplitudes refer; 0 uses them for every size.
        scale = state[row, H] / by_height if by_height > 0 else 1.0
        for k in range(np.uint64(4)):
            velocity = state[row, k + np.uint64(VX)]
            result[i, k] = state[row, k] + dt_s * velocity
            by_chance = scale * amplitude[k + np.uint64(1)] * noise[i, k + np.uint64(1)]
            result[i, k + np.uint64(VX)] = memory[k] * velocity + by_chance
        result[i, D] = state[row, D] + scale * amplitude[0] * noise[i, 0]
        slope = (result[i, X] - centre) / focal
        result[i, X] = centre + focal * (slope + along) / (np.float32(1) - slope * along)
    return result


@njit(cache=True, nogil=True, error_model="numpy")
def _rows_near_best(
    state: Floats, weight: Floats, least: np.float32, farthest: np.float32
) -> NDArray[np.uint64]:
    """List the rows of weighted samples within a distance from the best, in its semi-axes."""
    best, rows, count = state[np.argmax(weight)], np.empty(len(weight), dtype=np.uint64), np.uint64(0)
    # Counted without branches, as these would be unpredictable.
    if np.isinf(farthest):
        for i in range(np.uint64(len(weight))):
            rows[count] = i
            count += np.uint64(weight[i] >= least)
        return rows[:count]
    for i in range(np.uint64(len(weight))):
        across, down = (state[i, X] - best[X]) / best[W], (state[i, Y] - best[Y]) / best[H]
        rows[count] = i
        count += np.uint64((weight[i] >= least) & (across * across + down * down <= farthest))
    return rows[:count]


@njit(cache=True, nogil=True)
def _mean(state: Floats, weight: Floats) -> NDArray[np.float64]:
    """Return the weighted mean of states (N, 9) with weights (N,)."""
    mean = np.zeros(STATE_SIZE)
    for i in range(len(state)):
        for k in range(STATE_SIZE):
            mean[k] += np.float64(weight[i]) * state[i, k]
    return mean


@njit(cache=True, nogil=True)
def _spread(state: Floats, weight: Floats, mean: NDArray[np.float64]) -> float:
    """Return the weighted mean squared distance of x and y (N, 9) from their mean (9,)."""
    spread = 0.0
    for i in range(len(state)):
        across, down = state[i, X] - mean[X], state[i, Y] - mean[Y]
        spread += weight[i] * (across * across + down * down)
    return spread
