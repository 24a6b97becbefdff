"""Weighted hypotheses of one person's contour: resampling, estimate and uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.ellipse import Ellipse

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
FOOT: Final = 2.05  # feet below the body's centre, in body semi-heights

Floats = NDArray[np.float32]


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


def equally_weighted(state: Floats) -> Particles:
    """Give every one of the (N, 9) states the weight 1/N."""
    return Particles(state, np.full(len(state), 1 / len(state), dtype=np.float32))


def normalised(weight: Floats) -> Floats:
    """Scale (N,) non-negative weights to sum to 1; equal weights where none is positive."""
    total = float(weight.sum(dtype=np.float64))
    if not total > 0:
        return np.full(len(weight), 1 / len(weight), dtype=np.float32)
    return (weight / total).astype(np.float32)


def resample(particles: Particles, count: int, rng: np.random.Generator) -> Floats:
    """Draw the states (count, 9) of equally weighted particles by systematic resampling.

    Row i appears floor(count w_i) or ceil(count w_i) times; the whole draw uses one random number.

    Source: thesis, algorithm 4.
    """
    return particles.state[systematic_rows(particles.weight, count, rng.random())]


@njit(cache=True, nogil=True)
def systematic_rows(weight: Floats, count: int, offset: float) -> NDArray[np.int64]:
    """Find the rows (count,) under `count` evenly spaced marks on the cumulated weights; offset in [0, 1)."""
    rows = np.empty(count, dtype=np.int64)
    total, last = 0.0, 0
    for k in range(len(weight)):
        total += weight[k]
        if weight[k] > 0:
            last = k
    row = 0
    cumulated = float(weight[0])
    for j in range(count):
        mark = total * (offset + j) / count
        while mark >= cumulated and row < last:
            row += 1
            cumulated += weight[row]
        rows[j] = row
    return rows


def mean_state(particles: Particles) -> NDArray[np.float64]:
    """Average the (9,) state by weight.

    Source: thesis, equation 4.2; its extra 1/N is a slip once the weights are normalised.
    """
    return particles.weight.astype(np.float64) @ particles.state.astype(np.float64)


def uncertainty_px2(particles: Particles) -> float:
    """Measure the weighted squared distance of the particles from their mean, over x and y [px^2].

    Source: thesis, equation 4.6; read over the position alone, since the sources' threshold of 400 counts
    pixels.
    """
    weight = particles.weight.astype(np.float64)
    away = particles.state[:, :2].astype(np.float64)
    away -= weight @ away
    return float(weight @ (away * away).sum(axis=1))


def select(particles: Particles, rows: NDArray[np.int64]) -> Particles:
    """Keep some of the particles, their weights scaled to sum to 1."""
    return Particles(particles.state[rows], normalised(particles.weight[rows]))


def core_rows(particles: Particles, share: float, reach: float) -> NDArray[np.int64]:
    """Choose the particles that make the estimate: of the best ones, those near the very best.

    With several people in view the mean over all particles lies between them (thesis, figure 4.5); the mean
    over those near the best lies on one of them.

    Args:
        particles: the weighted samples.
        share: the ceil(share N) heaviest particles are kept, and their equals (paper: the best 30 %).
        reach: largest distance from the heaviest one, in its semi-axes; infinite for all.
    """
    count = math.ceil(share * len(particles))
    # The count-th heaviest weight: those equal to it stay, so that no sorting order decides.
    least = np.partition(particles.weight, len(particles) - count)[len(particles) - count]
    rows = np.flatnonzero(particles.weight >= least)
    if math.isinf(reach):
        return rows
    best = particles.state[np.argmax(particles.weight)]
    away = (particles.state[rows, :2] - best[:2]) / best[W : H + 1]
    near: NDArray[np.int64] = rows[(away * away).sum(axis=1) <= reach * reach]
    return near


def ellipse_of(state: NDArray[np.floating]) -> Ellipse:
    """Name the entries of one (9,) state."""
    return Ellipse(
        x=float(state[X]),
        y=float(state[Y]),
        w=float(state[W]),
        h=float(state[H]),
        d=float(state[D]),
        vx=float(state[VX]),
        vy=float(state[VY]),
        vw=float(state[VW]),
        vh=float(state[VH]),
    )
