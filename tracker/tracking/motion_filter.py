"""Positions and velocities of people in metres: one extended Kalman filter per track, vectorised."""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import inverse
from peopleboy.tracker.track import FloorPlace
from peopleboy.tracker.tracking.camera_motion import FrameMotion
from peopleboy.tracker.tracking.config import KalmanConfig
from peopleboy.tracker.tracking.viewpoint import Position, Viewpoint

Floats = NDArray[np.float64]


STATE: Final = 7
_LEAST_SPREAD: Final = 1e-9  # px^2


@dataclass(frozen=True, slots=True, eq=False)
class StateEstimates:
    """State estimates of K people's feet.

    Attributes:
        mean: (K, 7) position [m] and velocity [m/s] in the level frame, and build, the logarithm of
            the stature divided by the usual stature.
        covariance: (K, 7, 7) of the mean.
    """

    mean: Floats
    covariance: Floats

    def __len__(self) -> int:
        return len(self.mean)

    def take(self, rows: NDArray[np.intp]) -> "StateEstimates":
        """Return some of the states."""
        return StateEstimates(self.mean[rows], self.covariance[rows])

    def joined(self, others: "StateEstimates") -> "StateEstimates":
        """Return these and other states."""
        return StateEstimates(
            np.concatenate([self.mean, others.mean]), np.concatenate([self.covariance, others.covariance])
        )

    def replaced(self, rows: NDArray[np.intp], others: "StateEstimates") -> "StateEstimates":
        """Return a copy with some rows replaced."""
        mean, covariance = self.mean.copy(), self.covariance.copy()
        mean[rows], covariance[rows] = others.mean, others.covariance
        return StateEstimates(mean, covariance)


NO_STATES = StateEstimates(np.empty((0, STATE)), np.empty((0, STATE, STATE)))


class Linearised(NamedTuple):
    """A measurement model at K states.

    Attributes:
        values: (K, 3) expected measurements.
        slope: (K, 3, 7) their Jacobians.
    """

    values: Floats
    slope: Floats


def initiate(boxes: Floats, variance: Floats, view: Viewpoint, config: KalmanConfig) -> StateEstimates:
    """Initiate states from boxes (K, 4) with variances (K, 3) [px^2]; the velocity is unknown."""
    feet = view.feet(boxes)
    build = np.zeros(len(feet))
    slope = view.slopes(feet, build)
    back = inverse(slope[:, :, :3])
    grown = back @ slope[:, :, 3:]
    covariance = np.zeros((len(feet), STATE, STATE))
    noise = variance[:, :, None] * np.eye(3)
    noise = noise + slope[:, :, 3:] @ slope[:, :, 3:].transpose(0, 2, 1) * config.build**2
    covariance[:, :3, :3] = back @ noise @ back.transpose(0, 2, 1)
    covariance[:, 3:6, 3:6] = np.diag(np.square(config.speed_m_s))
    covariance[:, 6, 6] = config.build**2
    covariance[:, :3, 6] = -grown[:, :, 0] * config.build**2
    covariance[:, 6, :3] = covariance[:, :3, 6]
    return StateEstimates(np.concatenate([feet, np.zeros((len(feet), 4))], axis=1), covariance)


def predict(states: StateEstimates, dt_s: float, moved: FrameMotion, config: KalmanConfig) -> StateEstimates:
    """Predict the states for the next frame, with white acceleration, in the frame of the moved robot."""
    mean, covariance = np.empty_like(states.mean), np.empty_like(states.covariance)
    pushed = np.square(config.acceleration_m_s2)
    _walk_on(states.mean, states.covariance, dt_s, moved.turn, pushed, config.posture**2, mean, covariance)
    mean[:, :3] = (mean[:, :3] - moved.step_m) @ moved.turn.T
    mean[:, 2] = np.maximum(mean[:, 2], config.nearest_m)
    if moved.unsure_rad > 0.0:
        spread = np.square(moved.unsure_rad * mean[:, 2])
        covariance[:, 0, 0] += spread
        covariance[:, 1, 1] += spread
    return StateEstimates(mean, covariance)


def mahalanobis(states: StateEstimates, expected: Linearised, variance: Floats, seen: Floats) -> Floats:
    """Return the Mahalanobis distances (K, M) of measurements (M, 3) from K states.

    Args:
        states: K predicted states.
        expected: the measurement model at these states.
        variance: (K, 3) of the measurement noise.
        seen: (M, 3) measurements.
    """
    result = np.empty((len(states), len(seen)))
    _measure(states.covariance, expected.slope, variance, expected.values, seen, result)
    return result


def update(states: StateEstimates, expected: Linearised, variance: Floats, seen: Floats) -> StateEstimates:
    """Update each of K states with a measurement (K, 3) with variances (K, 3)."""
    if len(states) == 0:
        return states
    later = StateEstimates(states.mean.copy(), states.covariance.copy())
    _learn(later.mean, later.covariance, expected.slope, variance, seen - expected.values)
    return later


def linearise(states: StateEstimates, view: Viewpoint) -> Linearised:
    """Return the expected middle columns, and rows of heads and feet, in a camera's image."""
    feet, build = states.mean[:, :3], states.mean[:, 6]
    slope = np.zeros((len(states), 3, STATE))
    slope[:, :, (0, 1, 2, 6)] = view.slopes(feet, build)
    return Linearised(view.seen(feet, build), slope)


def constrain_to_floor(states: StateEstimates, floor_m: float, deviation_m: float) -> StateEstimates:
    """Update states with feet on the floor, at a depth below the origin."""
    covariance = states.covariance
    gain = covariance[:, :, 1] / (covariance[:, 1, 1] + deviation_m**2)[:, None]
    return StateEstimates(
        states.mean + gain * (floor_m - states.mean[:, 1])[:, None],
        covariance - gain[:, :, None] * covariance[:, 1, None, :],
    )


def predicted_boxes(states: StateEstimates, view: Viewpoint, ratio: Floats) -> Floats:
    """Return the boxes (K, 4) [px] of people of these widths (K,), in heights."""
    column, head, foot = view.seen(states.mean[:, :3], states.mean[:, 6]).T
    height = np.maximum(foot - head, 1.0)
    width = ratio * height
    boxes = np.stack([column - width / 2.0, foot - height, width, height], axis=1)
    return np.asarray(boxes, np.float64)


def floor_positions(states: StateEstimates, common_m: Floats, origin_m: Position) -> list[FloorPlace]:
    """Return positions and velocities on the floor in the robot frame.

    Args:
        states: K people.
        common_m: (K, 2) deviations of the positions across and along the line of sight that no further image
            reduces.
        origin_m: of the level frame.
    """
    forward, left, _ = origin_m
    place = states.mean[:, (0, 2)]
    sight = place / np.maximum(np.hypot(*place.T), 1e-6)[:, None]
    axes = np.stack([np.column_stack([sight[:, 1], -sight[:, 0]]), sight], axis=1)
    common = axes.transpose(0, 2, 1) @ (np.square(common_m)[:, :, None] * axes)
    spread = states.covariance[:, (0, 0, 2, 2), (0, 2, 0, 2)].reshape(-1, 2, 2) + common
    drifts = states.covariance[:, (3, 3, 5, 5), (3, 5, 3, 5)].reshape(-1, 2, 2)
    return [
        FloorPlace(
            position_m=(forward + ahead, left - right),
            covariance_m2=_to_robot(each),
            velocity_m_s=(ahead_m_s, -right_m_s),
            velocity_covariance_m2_s2=_to_robot(drift),
        )
        for (right, ahead), each, (right_m_s, ahead_m_s), drift in zip(
            place.tolist(), spread, states.mean[:, (3, 5)].tolist(), drifts, strict=True
        )
    ]


def _to_robot(covariance: Floats) -> tuple[float, float, float]:
    """Return xx, xy, yy in the robot frame of a covariance (2, 2) to the right and ahead."""
    return float(covariance[1, 1]), -float(covariance[0, 1]), float(covariance[0, 0])


@njit(cache=True, nogil=True)
def _walk_on(
    mean: Floats,
    covariance: Floats,
    dt_s: float,
    turn: Floats,
    pushed: Floats,
    grown: float,
    later: Floats,
    later_covariance: Floats,
) -> None:  # pragma: no cover
    """Predict means (K, 7) and covariances over a time step; velocities are rotated, positions are not."""
    way, once = np.zeros((STATE, STATE)), np.zeros((STATE, STATE))
    way[6, 6], once[6, 6] = 1.0, grown * dt_s
    for i in range(3):
        for j in range(3):
            way[i, j] = way[3 + i, 3 + j] = turn[i, j]
            way[i, 3 + j] = dt_s * turn[i, j]
            spread = 0.0
            for axis in range(3):
                spread += turn[i, axis] * pushed[axis] * turn[j, axis]
            once[i, j], once[3 + i, 3 + j] = dt_s**3 / 3.0 * spread, dt_s * spread
            once[i, 3 + j] = once[3 + i, j] = dt_s**2 / 2.0 * spread
    half = np.empty((STATE, STATE))
    for number in range(len(mean)):
        before, after = mean[number], later[number]
        after[6] = before[6]
        for i in range(3):
            after[i] = before[i] + dt_s * before[3 + i]
            after[3 + i] = turn[i, 0] * before[3] + turn[i, 1] * before[4] + turn[i, 2] * before[5]
        _multiply(way, covariance[number], half)
        _multiply(half, way.T, later_covariance[number])
        later_covariance[number] += once
        for i in range(STATE):
            for j in range(i):  # keeps the matrix symmetric: asymmetry would grow
                later_covariance[number, i, j] = later_covariance[number, j, i]


@njit(cache=True, nogil=True)
def _multiply(one: Floats, other: Floats, product: Floats) -> None:  # pragma: no cover
    for i in range(product.shape[0]):
        for j in range(product.shape[1]):
            total = 0.0
            for k in range(one.shape[1]):
                total += one[i, k] * other[k, j]
            product[i, j] = total


@njit(cache=True, nogil=True)
def _measure(
    covariance: Floats, slope: Floats, noise: Floats, expected: Floats, seen: Floats, result: Floats
) -> None:  # pragma: no cover
    """Return the Mahalanobis distances (K, M) of measurements (M, 3) from predictions (K, 3)."""
    across, root = np.empty((STATE, 3)), np.zeros((3, 3))
    gap = np.empty(3)
    for number in range(len(result)):
        _root_of_spread(covariance[number], slope[number], noise[number], across, root)
        for column in range(len(seen)):
            for axis in range(3):
                gap[axis] = seen[column, axis] - expected[number, axis]
            _solve(root, gap)
            result[number, column] = math.sqrt(gap[0] ** 2 + gap[1] ** 2 + gap[2] ** 2)


@njit(cache=True, nogil=True)
def _learn(
    mean: Floats, covariance: Floats, slope: Floats, noise: Floats, gap: Floats
) -> None:  # pragma: no cover
    """Update with the innovations (K, 3).

    Uses the Cholesky factor of the innovation covariance: with its inverse, covariances of long-lost tracks
    diverge.
    """
    across, root = np.empty((STATE, 3)), np.zeros((3, 3))
    for number in range(len(mean)):
        _root_of_spread(covariance[number], slope[number], noise[number], across, root)
        _solve(root, gap[number])
        for i in range(STATE):
            _solve(root, across[i])
        for i in range(STATE):
            for axis in range(3):
                mean[number, i] += across[i, axis] * gap[number, axis]
                for j in range(STATE):
                    covariance[number, i, j] -= across[i, axis] * across[j, axis]


@njit(cache=True, nogil=True)
def _root_of_spread(
    covariance: Floats, slope: Floats, noise: Floats, across: Floats, root: Floats
) -> None:  # pragma: no cover
    """Return P H' (7, 3) and the lower Cholesky factor (3, 3) of H P H' + noise."""
    _multiply(covariance, slope.T, across)
    _multiply(slope, across, root)
    for i in range(3):
        root[i, i] += noise[i]
        for j in range(i + 1):
            for k in range(j):
                root[i, j] -= root[i, k] * root[j, k]
            root[i, j] = math.sqrt(max(root[i, i], _LEAST_SPREAD)) if i == j else root[i, j] / root[j, j]


@njit(cache=True, nogil=True)
def _solve(root: Floats, result: Floats) -> None:  # pragma: no cover
    """Solve a lower triangular system (3, 3) by forward substitution."""
    for i in range(3):
        for j in range(i):
            result[i] -= root[i, j] * result[j]
        result[i] /= root[i, i]
