"""Where people are in metres and where they go: an extended Kalman filter for each, all at once."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.by_detection.config import PathConfig
from peopleboy.tracker.by_detection.viewpoint import NEAREST_M, Viewpoint
from peopleboy.tracker.frame import Odometry

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Paths:
    """What is believed of K people's feet.

    Attributes:
        mean: (K, 6) place [m] and velocity [m/s] in the level frame of the camera.
        covariance: (K, 6, 6) of the same.
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


NOBODY = Paths(np.empty((0, 6)), np.empty((0, 6, 6)))


def begun(boxes: Floats, view: Viewpoint, config: PathConfig) -> Paths:
    """Begin paths where people are proposed (K, 4); nobody knows where they go."""
    feet = view.feet(boxes)
    noise = _noise(boxes[:, 3], config)
    back = np.linalg.inv(view.slopes(feet))
    covariance = np.zeros((len(feet), 6, 6))
    covariance[:, :3, :3] = back @ noise @ back.transpose(0, 2, 1)
    covariance[:, 3:, 3:] = np.diag(np.square(config.speed_m_s))
    return Paths(np.concatenate([feet, np.zeros_like(feet)], axis=1), covariance)


def advanced(paths: Paths, dt_s: float, moved: Odometry, config: PathConfig) -> Paths:
    """Carry paths on to the next frame, by white acceleration, and into the frame of a robot that moved."""
    step = np.eye(6)
    step[:3, 3:] = dt_s * np.eye(3)
    grown = [[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]]
    spread = np.kron(grown, np.diag(np.square(config.acceleration_m_s2)))
    whole = np.kron(np.eye(2), _turn(moved))
    walked = paths.mean @ step.T
    mean = np.concatenate([carried(walked[:, :3], moved), walked[:, 3:] @ _turn(moved).T], axis=1)
    mean[:, 2] = np.maximum(mean[:, 2], NEAREST_M)
    covariance = step @ paths.covariance @ step.T + spread
    return Paths(mean, whole @ covariance @ whole.T)


def carried(points_m: Floats, moved: Odometry) -> Floats:
    """Give points (K, 3) of the level frame before the robot moved in that after it."""
    return np.asarray((points_m - (-moved.aside_m, 0.0, moved.advance_m)) @ _turn(moved).T)


def distances(paths: Paths, boxes: Floats, view: Viewpoint, config: PathConfig) -> Floats:
    """Give the Mahalanobis distances (K, M) of proposals (M, 4) from where people are expected."""
    gap, spread, _ = _innovation(paths, boxes, view, config)
    return np.asarray(np.sqrt(np.einsum("kmi,kij,kmj->km", gap, np.linalg.inv(spread), gap)))


def corrected(paths: Paths, boxes: Floats, view: Viewpoint, config: PathConfig) -> Paths:
    """Take in a box (K, 4) for each, and that feet are on the floor, where it is known."""
    if len(paths) == 0:
        return paths
    gap, spread, slope = _innovation(paths, boxes, view, config)
    gain = paths.covariance @ slope.transpose(0, 2, 1) @ np.linalg.inv(spread)
    own = gap[np.arange(len(paths)), np.arange(len(paths))]
    later = Paths(
        paths.mean + np.einsum("kij,kj->ki", gain, own),
        (np.eye(6) - gain @ slope) @ paths.covariance,
    )
    return later if view.floor_m is None else _on_floor(later, view.floor_m, config.floor_m)


def boxes_of(paths: Paths, view: Viewpoint, ratio: Floats) -> Floats:
    """Give the boxes (K, 4) [px] of people who are so wide (K,), in heights."""
    column, foot, log_height = view.seen(paths.mean[:, :3]).T
    height = np.exp(log_height)
    width = ratio * height
    boxes = np.stack([column - width / 2.0, foot - height, width, height], axis=1)
    return np.asarray(boxes, np.float64)


def _turn(moved: Odometry) -> Floats:
    """Give the rotation (3, 3) of the level frame into that of a robot that turned."""
    cosine, sine = math.cos(moved.turn_rad), math.sin(moved.turn_rad)
    return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])


def _innovation(
    paths: Paths, boxes: Floats, view: Viewpoint, config: PathConfig
) -> tuple[Floats, Floats, Floats]:
    """Give what is seen less what is expected (K, M, 3), the covariance (K, 3, 3) and slopes (K, 3, 6)."""
    feet = paths.mean[:, :3]
    expected = view.seen(feet)
    slope = np.zeros((len(paths), 3, 6))
    slope[:, :, :3] = view.slopes(feet)
    spread = slope @ paths.covariance @ slope.transpose(0, 2, 1) + _noise(np.exp(expected[:, 2]), config)
    left, top, width, height = boxes.T
    seen = np.stack([left + width / 2.0, top + height, np.log(height)], axis=1)
    return seen[None] - expected[:, None], spread, slope


def _noise(height: Floats, config: PathConfig) -> Floats:
    """Give the covariances (K, 3, 3) of what is seen of people of these heights (K,) [px]."""
    noise = np.zeros((len(height), 3, 3))
    noise[:, 0, 0] = (config.column * height) ** 2
    noise[:, 1, 1] = (config.foot * height) ** 2
    noise[:, 2, 2] = config.log_height**2
    return noise


def _on_floor(paths: Paths, floor_m: float, deviation_m: float) -> Paths:
    covariance = paths.covariance
    gain = covariance[:, :, 1] / (covariance[:, 1, 1] + deviation_m**2)[:, None]
    return Paths(
        paths.mean + gain * (floor_m - paths.mean[:, 1])[:, None],
        covariance - gain[:, :, None] * covariance[:, 1, None, :],
    )
