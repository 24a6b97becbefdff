"""Prediction of where tracked people walk: constant velocity, and a spread that grows with time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.track import FloorPlace

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadConfig:
    """Growth of the error of a prediction with time; fitted on training walks to hold 95 % in the ellipse.

    Attributes:
        along_m, across_m: [m] deviation along and across the path after 1 s, of a person who walks at 1 m/s.
        still_m: [m] deviation after 1 s of a person who stands.
        power: exponent of its growth with time.
        unknown_m_s: [m/s] deviation of a velocity that the tracker does not report.
    """

    along_m: float = 0.24
    across_m: float = 0.17
    still_m: float = 0.09
    power: float = 1.4
    unknown_m_s: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Predicted positions of K people at T times, in the frame of their current positions.

    Attributes:
        mean_m: (K, T, 2).
        covariance_m2: (K, T, 2, 2).
    """

    mean_m: Floats
    covariance_m2: Floats


def predict_positions(
    places: Sequence[FloorPlace], after_s: Floats, config: SpreadConfig | None = None
) -> Forecast:
    """Predict the positions of K people after times (T,) [s], who walk on with their velocities.

    A person whose velocity is unknown stands. The covariance adds that of the track, and what people do next.
    """
    config = SpreadConfig() if config is None else config
    unknown = (config.unknown_m_s**2, 0.0, config.unknown_m_s**2)
    position = np.reshape([one.position_m for one in places], (-1, 1, 2))
    velocity = np.reshape([one.velocity_m_s or (0.0, 0.0) for one in places], (-1, 2))
    drift = _matrices([one.velocity_covariance_m2_s2 or unknown for one in places])
    now = _matrices([one.covariance_m2 for one in places])
    return Forecast(
        position + velocity[:, None] * after_s[:, None],
        now + drift * np.square(after_s)[:, None, None] + _spread(velocity, after_s, config),
    )


def _spread(velocity: Floats, after_s: Floats, config: SpreadConfig) -> Floats:
    """Return covariances (K, T, 2, 2) [m2] of what people with velocities (K, 2) do next."""
    speed, angle = np.hypot(*velocity.T), np.arctan2(velocity[:, 1], velocity[:, 0])
    deviation = config.still_m + np.outer(speed, (config.along_m, config.across_m))
    grown = deviation[:, None] * np.power(after_s, config.power)[:, None]
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.stack([cos, -sin, sin, cos], axis=1).reshape(-1, 1, 2, 2)
    return np.asarray((turn * np.square(grown)[:, :, None]) @ turn.swapaxes(2, 3))


def _matrices(covariances: Sequence[tuple[float, float, float]]) -> Floats:
    """Return covariances (K, 1, 2, 2) from xx, xy, yy."""
    xx, xy, yy = np.reshape(covariances, (-1, 3)).T
    return np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 1, 2, 2)
