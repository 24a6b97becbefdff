"""Particle filter of a person's position on the floor (SA 4.6)."""

import math
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.reproductions.rgbd.observation_model import Body, Glance, look_at
from peopleboy.tracker.reproductions.rgbd.rgbd_config import FloorFilterConfig
from peopleboy.tracker.sensors.depth.depth_view import RgbdView

_FRAME_S = 1.0 / 15.0  # frame time to which the spreads refer
_BEST_SHARE = 0.05
_HOLD_BELOW = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class FloorFilter:
    """P equally weighted particles of one person.

    Attributes:
        state: (P, 4) x forward, y left [m] and velocities [m/s] in the robot frame (SA eq. 4.23).
    """

    state: Floats

    @classmethod
    def begin(cls, place_m: Floats, config: FloorFilterConfig, rng: np.random.Generator) -> "FloorFilter":
        """Draw particles around a position (2,)."""
        state = np.zeros((config.particles, 4))
        state[:, :2] = place_m + rng.normal(0.0, config.random_m, (config.particles, 2))
        state[:, 2:] = rng.normal(0.0, config.random_m_s, (config.particles, 2))
        return cls(state)

    @property
    def place_m(self) -> Floats:
        """(2,) mean position."""
        return np.asarray(self.state[:, :2].mean(axis=0))

    def carried(self, motion: Pose2) -> "FloorFilter":
        """Return the particles in the frame of the moved robot."""
        return FloorFilter(
            np.hstack([motion.points_to_local(self.state[:, :2]), motion.vectors_to_local(self.state[:, 2:])])
        )

    def predicted(self, dt_s: float, config: FloorFilterConfig, rng: np.random.Generator) -> "FloorFilter":
        """Predict: most particles keep walking, the others move at random (SA 4.6, as 3.7 to 3.10)."""
        count = len(self.state)
        walks = np.arange(count) < round(config.forward_share * count)
        grown = math.sqrt(dt_s / _FRAME_S)
        place = np.where(walks, config.walk_m, config.random_m) * grown
        speed = np.where(walks, config.walk_m_s, config.random_m_s) * grown
        noise = rng.normal(0.0, 1.0, (count, 4)) * np.stack([place, place, speed, speed], axis=1)
        moved = self.state + noise
        moved[:, :2] += np.where(walks[:, None], self.state[:, 2:] * dt_s, 0.0)
        return FloorFilter(moved)

    def weighed(
        self, view: RgbdView, body: Body, config: FloorFilterConfig, rng: np.random.Generator
    ) -> "Update":
        """Weight particles by the images at their positions (SA eq. 4.26 to 4.28), and resample."""
        glance = look_at(view, self.state[:, :2], body, config.foreground_m)
        kernel = np.exp(-0.5 * (glance.miss_m / config.kernel_m) ** 2)
        count = max(1, round(_BEST_SHARE * len(kernel)))
        best = float(np.sort(kernel)[-count:].mean())
        if config.has_hold and best < _HOLD_BELOW:
            return Update(self, self.place_m, 0.0, glance, is_held=True)
        weight = kernel * _by_appearance(glance.similarity, config.sharpness)
        total = float(weight.sum())
        if total <= 0.0:
            return Update(self, self.place_m, 0.0, glance, is_held=True)
        weight /= total
        place = weight @ self.state[:, :2]
        confidence = float(weight @ (glance.similarity * kernel))
        drawn = np.searchsorted(np.cumsum(weight), (np.arange(len(weight)) + rng.random()) / len(weight))
        state = self.state[np.minimum(drawn, len(weight) - 1)]
        return Update(replace(self, state=state), place, confidence, glance, is_held=False)


@dataclass(frozen=True, slots=True, eq=False)
class Update:
    """Result of an update.

    Attributes:
        filter: with the new particles.
        place_m: (2,) weighted mean of the old particles.
        confidence: 0..1, weighted mean of similarity times kernel.
        glance: readings at the positions of the old particles.
        is_held: whether there were no readings, so that the filter only predicted.
    """

    filter: FloorFilter
    place_m: Floats
    confidence: float
    glance: Glance
    is_held: bool


def _by_appearance(similarity: Floats, sharpness: float) -> Floats:
    if sharpness <= 0.0:
        return similarity
    return np.asarray(np.exp(-(1.0 - similarity) / (2.0 * sharpness**2)))
