"""Prediction with the current velocity, and a spread that grows with time."""

from dataclasses import dataclass

import numpy as np

from peopleboy.tracker.prediction.tracked_people import Floats, Forecast, TrackedPeople


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadConfig:
    """Growth of the error of a prediction with time; fitted on training walks to hold 95 % in the ellipse.

    Attributes:
        along_m, across_m: [m] deviation along and across the path after 1 s, of a person who walks at 1 m/s.
        still_m: [m] deviation after 1 s of a person who stands.
        power: exponent of its growth with time.
    """

    along_m: float = 0.24
    across_m: float = 0.17
    still_m: float = 0.09
    power: float = 1.4


class ConstantVelocity:
    """People walk on with the velocity of the motion filter."""

    def __init__(self, config: SpreadConfig | None = None) -> None:
        self._config = SpreadConfig() if config is None else config

    def predict(self, people: TrackedPeople, after_s: Floats) -> Forecast:
        """Predict straight paths."""
        walked_m = people.velocity_m_s[:, None] * after_s[:, None]
        return Forecast(people.position_m[:, None] + walked_m, spread(people, after_s, self._config))


def directions(velocities: Floats) -> Floats:
    """Return unit vectors (K, 2) along velocities (K, 2); along x for people who stand."""
    speed = np.hypot(*velocities.T)
    angle = np.where(speed > 0.0, np.arctan2(velocities[:, 1], velocities[:, 0]), 0.0)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def axes(velocities: Floats) -> Floats:
    """Return rotations (K, 2, 2) whose columns point along and to the left of velocities (K, 2)."""
    ahead = directions(velocities)
    return np.stack([ahead, np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)], axis=2)


def spread(people: TrackedPeople, after_s: Floats, config: SpreadConfig) -> Floats:
    """Return covariances (K, T, 2, 2) [m2] after times (T,) [s]: of the track, and of what people do next."""
    speed = np.hypot(*people.velocity_m_s.T)
    deviation = config.still_m + np.outer(speed, (config.along_m, config.across_m))
    grown = deviation[:, None] * np.power(after_s, config.power)[:, None]
    turn = axes(people.velocity_m_s)[:, None]
    steps = (turn * np.square(grown)[:, :, None]) @ turn.swapaxes(2, 3)
    drift = people.velocity_covariance_m2_s2[:, None] * np.square(after_s)[:, None, None]
    return np.asarray(people.covariance_m2[:, None] + drift + steps)
