"""Prediction by the social force model: people keep their velocity, and give way to others and to the robot.

Source: Helbing and Molnar, Social force model for pedestrian dynamics, Phys. Rev. E 51, 4282 (1995), with
elliptical repulsion by relative velocity (Johansson, Helbing and Shukla 2007).
"""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from peopleboy.tracker.prediction.constant_velocity import SpreadConfig, spread
from peopleboy.tracker.prediction.tracked_people import Floats, Forecast, TrackedPeople

_NEAR_M: Final = 1e-3  # people at the same place push with a finite force
_LEAST_M2: Final = 1e-2  # square of the smallest axis of the ellipses


@dataclass(frozen=True, slots=True, kw_only=True)
class SocialForceConfig:
    """Constants of the model.

    Attributes:
        relaxation_s: [s] time in which people regain the velocity that they want.
        strength_m2_s2, range_m: [m2/s2], [m] repulsion by other people and the robot.
        foresight_s: [s] time ahead of a step that others foresee.
        behind: weight of people out of sight.
        half_sight_cos: cosine of half the field of view.
        most_m_s2: [m/s2] highest acceleration.
        step_s: [s] longest step of the integration.
        spread: growth of the error.
    """

    relaxation_s: float = 0.5
    strength_m2_s2: float = 2.1
    range_m: float = 0.3
    foresight_s: float = 1.0
    behind: float = 0.5
    half_sight_cos: float = -0.17
    most_m_s2: float = 4.0
    step_s: float = 0.1
    spread: SpreadConfig = field(default_factory=SpreadConfig)


class SocialForce:
    """People give way to each other and to the robot, which goes on with its velocity."""

    def __init__(self, config: SocialForceConfig | None = None) -> None:
        self._config = SocialForceConfig() if config is None else config

    def predict(self, people: TrackedPeople, after_s: Floats) -> Forecast:
        """Integrate the accelerations of all people together."""
        config, count = self._config, len(people)
        places = np.concatenate([people.position_m, np.zeros((1, 2))])
        velocities = np.concatenate([people.velocity_m_s, people.robot_m_s[None]])
        mean, now_s = np.empty((count, len(after_s), 2)), 0.0
        for column, end_s in enumerate(after_s.tolist()):
            steps = max(int(np.ceil((end_s - now_s) / config.step_s - 1e-9)), 1)
            for _ in range(steps):
                dt_s = (end_s - now_s) / steps
                force = self._forces(places, velocities, people.velocity_m_s)
                velocities[:count] += dt_s * force
                places = places + dt_s * velocities
            now_s, mean[:, column] = end_s, places[:count]
        return Forecast(mean, spread(people, after_s, config.spread))

    def _forces(self, places: Floats, velocities: Floats, wanted: Floats) -> Floats:
        """Return the accelerations (K, 2) [m/s2] of people; the last place and velocity are the robot's."""
        config, count = self._config, len(wanted)
        gap = places[:count, None] - places[None]
        step = config.foresight_s * (velocities[None] - velocities[:count, None])
        away = np.maximum(np.linalg.norm(gap, axis=2), _NEAR_M)
        ahead = gap - step
        later = np.maximum(np.linalg.norm(ahead, axis=2), _NEAR_M)
        both = away + later
        axis_m = np.sqrt(np.maximum(both**2 - np.square(step).sum(axis=2), _LEAST_M2)) / 2.0
        push = (
            config.strength_m2_s2 / config.range_m * np.exp(-axis_m / config.range_m) * both / (4.0 * axis_m)
        )
        push = push * np.where(self._sees(gap, away, wanted), 1.0, config.behind)
        push[np.arange(count), np.arange(count)] = 0.0
        force = (push[:, :, None] * (gap / away[:, :, None] + ahead / later[:, :, None])).sum(axis=1)
        force += (wanted - velocities[:count]) / config.relaxation_s
        size = np.linalg.norm(force, axis=1, keepdims=True)
        return np.asarray(force * np.minimum(1.0, config.most_m_s2 / np.maximum(size, 1e-9)))

    def _sees(
        self, gap: Floats, away: Floats, wanted: Floats
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Return whether others (K, K + 1) are in people's field of view."""
        speed = np.maximum(np.linalg.norm(wanted, axis=1), 1e-9)
        ahead = -(gap * wanted[:, None]).sum(axis=2)
        return np.asarray(ahead >= speed[:, None] * away * self._config.half_sight_cos)
