"""Where people are in metres and where they go: an extended Kalman filter for each, all at once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.by_detection.config import PathConfig
from peopleboy.tracker.by_detection.viewpoint import NEAREST_M, Viewpoint
from peopleboy.tracker.frame import Odometry

Floats = NDArray[np.float64]


STATE: Final = 7


@dataclass(frozen=True, slots=True, eq=False)
class Paths:
    """What is believed of K people's feet.

    Attributes:
        mean: (K, 7) place [m] and velocity [m/s] in the level frame of the camera, and build, the
            logarithm of the stature over the usual one.
        covariance: (K, 7, 7) of the same.
    """

    mean: Floats
    covariance: Floats

    def __len__(self) -> int:
        return len(self.mean)

    def take(self, rows: NDArray[np.intp]) -> Paths:
        """Give some of them."""
        return Paths(self.mean[rows], self.covariance[rows])

    def joined(self, others: Paths) -> Paths:
        """Give these and others."""
        return Paths(
            np.concatenate([self.mean, others.mean]), np.concatenate([self.covariance, others.covariance])
        )

    def replaced(self, rows: NDArray[np.intp], others: Paths) -> Paths:
        """Give these, with others in some rows."""
        mean, covariance = self.mean.copy(), self.covariance.copy()
        mean[rows], covariance[rows] = others.mean, others.covariance
        return Paths(mean, covariance)


NOBODY = Paths(np.empty((0, STATE)), np.empty((0, STATE, STATE)))


def begun(boxes: Floats, view: Viewpoint, config: PathConfig) -> Paths:
    """Begin paths where people are proposed (K, 4); nobody knows where they go."""
    feet = view.feet(boxes)
    build = np.zeros(len(feet))
    slope = view.slopes(feet, build)
    back = np.linalg.inv(slope[:, :, :3])
    grown = back @ slope[:, :, 3:]
    covariance = np.zeros((len(feet), STATE, STATE))
    noise = _noise(boxes[:, 3], config)
    noise = noise + slope[:, :, 3:] @ slope[:, :, 3:].transpose(0, 2, 1) * config.build**2
    covariance[:, :3, :3] = back @ noise @ back.transpose(0, 2, 1)
    covariance[:, 3:6, 3:6] = np.diag(np.square(config.speed_m_s))
    covariance[:, 6, 6] = config.build**2
    covariance[:, :3, 6] = -grown[:, :, 0] * config.build**2
    covariance[:, 6, :3] = covariance[:, :3, 6]
    begun_at = Paths(np.concatenate([feet, np.zeros((len(feet), 4))], axis=1), covariance)
    return begun_at if view.floor_m is None else _on_floor(begun_at, view.floor_m, config.floor_m)


def advanced(paths: Paths, dt_s: float, moved: Odometry, config: PathConfig) -> Paths:
    """Carry paths on to the next frame, by white acceleration, and into the frame of a robot that moved."""
    step = np.eye(STATE)
    step[:3, 3:6] = dt_s * np.eye(3)
    pushed = np.diag(np.square(config.acceleration_m_s2))
    spread = np.zeros((STATE, STATE))
    spread[:3, :3], spread[3:6, 3:6] = dt_s**3 / 3.0 * pushed, dt_s * pushed
    spread[:3, 3:6] = spread[3:6, :3] = dt_s**2 / 2.0 * pushed
    spread[6, 6] = config.posture**2 * dt_s
    whole = np.eye(STATE)
    whole[:3, :3] = whole[3:6, 3:6] = _turn(moved)
    walked = paths.mean @ step.T
    mean = walked @ whole.T
    mean[:, :3] = carried(walked[:, :3], moved)
    mean[:, 2] = np.maximum(mean[:, 2], NEAREST_M)
    covariance = step @ paths.covariance @ step.T + spread
    return Paths(mean, whole @ covariance @ whole.T)


def carried(points_m: Floats, moved: Odometry) -> Floats:
    """Give points (K, 3) of the level frame before the robot moved in that after it."""
    return np.asarray((points_m - (-moved.aside_m, 0.0, moved.advance_m)) @ _turn(moved).T)


def distances(paths: Paths, boxes: Floats, view: Viewpoint, config: PathConfig) -> Floats:
    """Give the Mahalanobis distances (K, M) of proposals (M, 4) from where people are expected."""
    expected, slope = _expected(paths, view)
    height = np.maximum(expected[:, 2] - expected[:, 1], 1.0)
    spread = _spread(paths, slope, _noise(height, config))
    gap = _ends(boxes)[None] - expected[:, None]
    return np.asarray(np.sqrt(np.einsum("kmi,kij,kmj->km", gap, np.linalg.inv(spread), gap)))


def corrected(paths: Paths, boxes: Floats, view: Viewpoint, config: PathConfig) -> Paths:
    """Take in a box (K, 4) for each, and that feet are on the floor, where it is known."""
    if len(paths) == 0:
        return paths
    expected, slope = _expected(paths, view)
    spread = _spread(paths, slope, _noise(boxes[:, 3], config))
    gain = paths.covariance @ slope.transpose(0, 2, 1) @ np.linalg.inv(spread)
    later = Paths(
        paths.mean + np.einsum("kij,kj->ki", gain, _ends(boxes) - expected),
        (np.eye(STATE) - gain @ slope) @ paths.covariance,
    )
    return later if view.floor_m is None else _on_floor(later, view.floor_m, config.floor_m)


def boxes_of(paths: Paths, view: Viewpoint, ratio: Floats) -> Floats:
    """Give the boxes (K, 4) [px] of people who are so wide (K,), in heights."""
    column, head, foot = view.seen(paths.mean[:, :3], paths.mean[:, 6]).T
    height = np.maximum(foot - head, 1.0)
    width = ratio * height
    boxes = np.stack([column - width / 2.0, foot - height, width, height], axis=1)
    return np.asarray(boxes, np.float64)


def _turn(moved: Odometry) -> Floats:
    """Give the rotation (3, 3) of the level frame into that of a robot that turned."""
    cosine, sine = math.cos(moved.turn_rad), math.sin(moved.turn_rad)
    return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])


def _expected(paths: Paths, view: Viewpoint) -> tuple[Floats, Floats]:
    """Give what is expected to be seen (K, 3), and its slopes (K, 3, 7)."""
    feet, build = paths.mean[:, :3], paths.mean[:, 6]
    slope = np.zeros((len(paths), 3, STATE))
    slope[:, :, (0, 1, 2, 6)] = view.slopes(feet, build)
    return view.seen(feet, build), slope


def _spread(paths: Paths, slope: Floats, noise: Floats) -> Floats:
    """Give the covariances (K, 3, 3) of what is seen."""
    return np.asarray(slope @ paths.covariance @ slope.transpose(0, 2, 1) + noise)


def _ends(boxes: Floats) -> Floats:
    """Give middle column, rows of head and feet (M, 3) of boxes (M, 4)."""
    left, top, width, height = boxes.T
    return np.stack([left + width / 2.0, top, top + height], axis=1)


def _noise(height: Floats, config: PathConfig) -> Floats:
    """Give the covariances (K, 3, 3) of the ends of boxes of these heights (K,) [px]."""
    noise = np.zeros((len(height), 3, 3))
    for row, deviation in enumerate((config.column, config.head, config.foot)):
        noise[:, row, row] = (deviation * height) ** 2
    return noise


def _on_floor(paths: Paths, floor_m: float, deviation_m: float) -> Paths:
    covariance = paths.covariance
    gain = covariance[:, :, 1] / (covariance[:, 1, 1] + deviation_m**2)[:, None]
    return Paths(
        paths.mean + gain * (floor_m - paths.mean[:, 1])[:, None],
        covariance - gain[:, :, None] * covariance[:, 1, None, :],
    )
