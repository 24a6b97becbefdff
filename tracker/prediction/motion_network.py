"""Prediction by a small network that was trained on simulated walks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.prediction.constant_velocity import axes
from peopleboy.tracker.prediction.tracked_people import STEPS, Floats, Forecast, TrackedPeople

MODEL: Final = "motion"
KNOTS_S: Final = np.arange(1.0, 6.0)
"""Times of the network's outputs [s]; between them, offsets and deviations are interpolated."""
NEIGHBOURS: Final = 3
"""Number of nearest people that the network takes into account."""
INPUTS: Final = 3 * (STEPS - 1) + 3 + 4 + 5 * NEIGHBOURS
OUTPUTS: Final = 4 * len(KNOTS_S)
REACH_M: Final = 6.0
"""Distance at which a neighbour has no effect; also that of neighbours who are not there."""
_SPECS: Final = {
    "first": ArraySpec((INPUTS + 1, "units")),
    "second": ArraySpec(("units + 1", "more")),
    "last": ArraySpec(("more + 1", OUTPUTS)),
    "scale": ArraySpec((len(KNOTS_S),)),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MotionNetwork:
    """Predictor of offsets from the straight path and of their deviations, along and across the path.

    Attributes:
        layers: first (INPUTS + 1, U), second (U + 1, V), and last (V + 1, OUTPUTS) layer; the last row is the
            bias.
        scale: (5,) factors of the deviations at the knots with which 95 % of people are in the ellipse.
        about: description of the training.
    """

    layers: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]
    scale: NDArray[np.float32]
    about: Mapping[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the weights."""
        first, second, last = self.layers
        arrays = {"first": first, "second": second, "last": last, "scale": self.scale}
        WeightsArchive(arrays, self.about).save(path)

    @classmethod
    def load(cls, path: Path = SHIPPED / f"{MODEL}.npz") -> Self:
        """Read the weights.

        Raises:
            BadInput: the file is missing, or holds other weights.
        """
        found = WeightsArchive.load(path, MODEL, _SPECS)
        first, second, last, scale = (found.arrays[name] for name in _SPECS)
        return cls(layers=(first, second, last), scale=scale, about=found.about)

    def predict(self, people: TrackedPeople, after_s: Floats) -> Forecast:
        """Predict the straight path and the network's offsets."""
        values = inputs_of(people)
        for layer in self.layers[:-1]:
            values = np.maximum(values @ layer[:-1] + layer[-1], 0.0)
        last = self.layers[-1]
        offset, deviation = offsets_and_deviations((values @ last[:-1] + last[-1]).astype(np.float64))
        offset = _at(after_s, offset, np.zeros((len(people), 1, 2)))
        ways = axes(people.velocity_m_s)
        now_m2 = np.diagonal(ways.swapaxes(1, 2) @ people.covariance_m2 @ ways, axis1=1, axis2=2)
        deviation = _at(after_s, deviation * self.scale[:, None], np.sqrt(now_m2)[:, None])
        turn = ways[:, None]
        straight = people.position_m[:, None] + people.velocity_m_s[:, None] * after_s[:, None]
        mean = straight + (turn @ offset[..., None])[..., 0]
        return Forecast(mean, (turn * np.square(deviation)[:, :, None]) @ turn.swapaxes(2, 3))


def shipped_network() -> MotionNetwork:
    """Return the network that PeopleBoy ships."""
    return MotionNetwork.load()


def offsets_and_deviations(outputs: Floats) -> tuple[Floats, Floats]:
    """Return offsets (K, 5, 2) [m] along and across the path, and their deviations, from outputs."""
    pairs = outputs.reshape(len(outputs), len(KNOTS_S), 4)
    return KNOTS_S[:, None] * pairs[..., :2], KNOTS_S[:, None] * np.exp(pairs[..., 2:])


def inputs_of(people: TrackedPeople) -> NDArray[np.float32]:
    """Return the inputs (K, INPUTS): path, speed, their uncertainty, the robot and the nearest people."""
    count, turn = len(people), axes(people.velocity_m_s)
    past = (people.path_m[:, :-1] - people.position_m[:, None]) @ turn
    is_known = np.isfinite(past[..., 0])
    own = [
        np.where(is_known[..., None], past, 0.0).reshape(count, 2 * (STEPS - 1)),
        is_known,
        np.linalg.norm(people.velocity_m_s, axis=1)[:, None],
        np.sqrt(np.trace(people.covariance_m2, axis1=1, axis2=2))[:, None],
        np.sqrt(np.trace(people.velocity_covariance_m2_s2, axis1=1, axis2=2))[:, None],
        _relative(people, turn, np.zeros((count, 2)), np.broadcast_to(people.robot_m_s, (count, 2))),
    ]
    return np.concatenate([*own, _neighbours(people, turn)], axis=1).astype(np.float32)


def _neighbours(people: TrackedPeople, turn: Floats) -> Floats:
    """Return place, velocity and presence (K, 5 * NEIGHBOURS) of the nearest people; 0 for absent ones."""
    count = len(people)
    found = np.zeros((count, NEIGHBOURS, 5))
    away = np.linalg.norm(people.position_m[:, None] - people.position_m[None], axis=2)
    np.fill_diagonal(away, np.inf)
    order = np.argsort(away, axis=1, kind="stable")[:, :NEIGHBOURS]
    for column in range(order.shape[1]):
        other = order[:, column]
        is_near = away[np.arange(count), other] < REACH_M
        relative = _relative(people, turn, people.position_m[other], people.velocity_m_s[other])
        found[:, column, :4] = np.where(is_near[:, None], relative, 0.0)
        found[:, column, 4] = is_near
    return found.reshape(count, 5 * NEIGHBOURS)


def _relative(people: TrackedPeople, turn: Floats, places: Floats, velocities: Floats) -> Floats:
    """Return places and velocities (K, 4) of others as people see them; far places are clipped."""
    gap = ((places - people.position_m)[:, None] @ turn)[:, 0]
    gap = gap * np.minimum(1.0, REACH_M / np.maximum(np.linalg.norm(gap, axis=1, keepdims=True), 1e-9))
    return np.concatenate([gap, (velocities[:, None] @ turn)[:, 0]], axis=1)


def _at(after_s: Floats, knots: Floats, start: Floats) -> Floats:
    """Interpolate values (K, 5, 2) at the knots to times (T,), from a start (K, 1, 2) at 0 s."""
    times = np.concatenate([[0.0], KNOTS_S])
    values = np.concatenate([np.broadcast_to(start, (len(knots), 1, 2)), knots], axis=1)
    right = np.clip(np.searchsorted(times, after_s), 1, len(times) - 1)
    share = np.clip((after_s - times[right - 1]) / (times[right] - times[right - 1]), 0.0, 1.0)[:, None]
    return np.asarray(values[:, right - 1] * (1.0 - share) + values[:, right] * share)
