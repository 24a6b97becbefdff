"""Moving objects as upright ellipses, each tracked by a particle filter with mean shift (SA 3.5)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from peopleboy.studies.reproductions.scene_model.clusters import Clusters
from peopleboy.studies.reproductions.scene_model.printed_config import EllipseConfig, PrintedConfig
from peopleboy.tracker.frame import Floats
from peopleboy.tracker.scene_model.connected_pieces import Bools


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MovingEllipse:
    """A hypothesis of a moving object.

    Attributes:
        id: from 1 on.
        state: (6,) x, y [m], heading [rad], speed [m per frame], radii [m] (SA eq. 3.6).
        unseen: consecutive frames without a cluster in it.
    """

    id: int
    state: Floats
    unseen: int = 0


class MovingEllipses:
    """Detects and tracks all moving objects.

    Args:
        config: settings.
        rng: draws particles.
    """

    def __init__(self, config: PrintedConfig, rng: np.random.Generator) -> None:
        self._config, self._rng = config, rng
        self._last_id = 0
        self.known: tuple[MovingEllipse, ...] = ()

    def update(self, clusters: Clusters) -> tuple[MovingEllipse, ...]:
        """Update known objects, and detect new ones."""
        followed = [self._followed(one, clusters) for one in self.known]
        kept = [one for one in _without_doubles(followed) if one.unseen <= self._config.ellipse.lost]
        self.known = (*kept, *self._detected(clusters, kept))
        return self.known

    def _followed(self, one: MovingEllipse, clusters: Clusters) -> MovingEllipse:
        config = self._config.ellipse
        particles = propagated(one.state, config, self._rng)
        ratings = _rate(
            particles, clusters.place_m, clusters.weight, clusters.velocity_m, config.shifts,
            config.near_m, config.alike_m, config.thin_m, config.wide_m,
        )  # fmt: skip
        best = int(ratings.argmax())
        if ratings[best] <= 0.0:
            return replace(one, unseen=one.unseen + 1)
        return replace(one, state=particles[best], unseen=0)

    def _detected(self, clusters: Clusters, known: Sequence[MovingEllipse]) -> list[MovingEllipse]:
        """Search moving clusters with an ellipse; 20 nearby points with similar motion suffice."""
        config = self._config
        is_free = clusters.is_moving.copy()
        for one in known:
            is_free &= ~inside(one.state, clusters.place_m, 1.3)
        found = []
        for k in np.argsort(-clusters.weight).tolist():
            if not is_free[k]:
                continue
            near = np.hypot(*(clusters.place_m - clusters.place_m[k]).T) < config.detect_m
            alike = _cosines(clusters.velocity_m, clusters.velocity_m[k]) > config.detect_cosine
            own = is_free & near & alike
            weight = clusters.weight * own
            if weight.sum() < config.detect_points:
                continue
            (x, y), (vx, vy) = (
                weight @ values / weight.sum() for values in (clusters.place_m, clusters.velocity_m)
            )
            radius = config.ellipse.radius_m
            self._last_id += 1
            state = np.array([x, y, np.arctan2(vy, vx), np.hypot(vx, vy), radius, radius])
            found.append(MovingEllipse(id=self._last_id, state=state))
            is_free &= ~inside(state, clusters.place_m, 1.0)
        return found


def propagated(state: Floats, config: EllipseConfig, rng: np.random.Generator) -> Floats:
    """Predict particles (N, 6): a share keeps moving, the others move at random (SA eq. 3.7-3.22).

    Corrected: the source blends both motions in every particle; its noise has the old value as its mean,
        which would
    double the state; its arc is not divided by the turn, so that nobody could walk straight on.
    """
    count = config.particles
    ordered = round(config.first_order * count)
    particles = np.tile(state, (count, 1))
    x, y, heading, speed = state[:4].tolist()
    turn = rng.normal(0.0, config.turn_sd, ordered)
    arc = speed * np.sinc(turn / (2.0 * np.pi))  # 2 v/w sin(w/2), which is v without a turn
    particles[:ordered, 0] = x + arc * np.cos(heading + turn / 2.0)
    particles[:ordered, 1] = y + arc * np.sin(heading + turn / 2.0)
    particles[:ordered, 2] = heading + turn + rng.normal(0.0, config.turn_sd, ordered)
    particles[:ordered, 3] = speed + rng.normal(0.0, config.speed_sd_m, ordered)
    spread = (config.place_sd_m, config.place_sd_m, config.heading_sd, config.speed_sd_m)
    particles[ordered:, :4] += rng.normal(0.0, spread, (count - ordered, 4))
    particles[:, 4:] += rng.normal(0.0, config.radius_sd_m, (count, 2))
    particles[:, 4:] = np.clip(particles[:, 4:], config.least_m, config.most_m)
    return particles


def inside(state: Floats, places_m: Floats, scale: float) -> Bools:
    """Return which positions (N, 2) are in an ellipse enlarged by a factor."""
    return np.asarray((((places_m - state[:2]) / (scale * state[4:6])) ** 2).sum(axis=1) < 1.0)


@njit(cache=True, nogil=True)
def _rate(particles, place, weight, velocity, shifts, near, alike, thin, wide):  # type: ignore[no-untyped-def]
    """Shift particles to clusters, and weight them (SA eq. 3.23-3.26).

    Corrected: the terms of eq. 3.24 are exchanged, as its sign would be negative; clusters count by their
    points, as the text says.
    """
    ratings = np.zeros(len(particles))
    for n in range(len(particles)):
        one = particles[n]
        vx, vy = one[3] * np.cos(one[2]), one[3] * np.sin(one[2])
        for step in range(shifts + 1):
            total, x, y = 0.0, 0.0, 0.0
            for k in range(len(weight)):
                dx, dy = place[k, 0] - one[0], place[k, 1] - one[1]
                if (dx / one[4]) ** 2 + (dy / one[5]) ** 2 >= 1.0:
                    continue
                apart = (velocity[k, 0] - vx) ** 2 + (velocity[k, 1] - vy) ** 2
                share = weight[k] * np.exp(
                    -(dx * dx + dy * dy) / (2.0 * near * near) - apart / (2.0 * alike * alike)
                )
                total, x, y = total + share, x + share * place[k, 0], y + share * place[k, 1]
            if total <= 0.0:
                break
            if step < shifts:
                one[0], one[1] = x / total, y / total
            else:
                square = one[4] * one[5]
                radial = np.exp(-square / (2.0 * wide * wide)) - np.exp(-square / (2.0 * thin * thin))
                ratings[n] = radial * total
    return ratings


def _cosines(velocities: Floats, one: Floats) -> Floats:
    lengths = np.hypot(*velocities.T) * np.hypot(*one)
    return np.asarray(velocities @ one / np.maximum(lengths, 1e-9))


def _without_doubles(ellipses: Sequence[MovingEllipse]) -> list[MovingEllipse]:
    """Remove duplicates at one position, keeping the oldest."""
    kept: list[MovingEllipse] = []
    for one in ellipses:
        if all(np.hypot(*(one.state[:2] - other.state[:2])) > 0.2 for other in kept):
            kept.append(one)
    return kept
