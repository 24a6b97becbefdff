"""Train the network that predicts where people walk, on walks of random worlds and of the library."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.optimiser import Optimiser, Weights, he_weights, shuffled
from peopleboy.studies.training.samples import SampleTask, Split, Tasks, sample_folder
from peopleboy.studies.training.specification import Specification
from peopleboy.studies.training.walks import Walks, WalkSample, collect_library, collect_world, samples_of
from peopleboy.tracker.prediction.constant_velocity import axes
from peopleboy.tracker.prediction.motion_network import (
    INPUTS,
    KNOTS_S,
    MODEL,
    OUTPUTS,
    MotionNetwork,
    inputs_of,
)
from peopleboy.tracker.prediction.prediction_metrics import ELLIPSE_95, squared_mahalanobis

FIRST_WORLD: Final = 50_000
"""Seed of the first random world for training; evaluation uses lower ones."""
SCENARIOS: Final = (
    *("absence_10s", "behind_door", "calls_robot", "corridor_meeting", "corridor_pair_passes", "crossing_2"),
    *("crossing_2_moving", "crossing_3", "crossing_pair", "crowd_8_moving", "crowded_foyer"),
    *("follow_absence", "follow_round", "follow_visitors", "garage", "group_abreast_moving"),
    *("group_keeps_together", "hall_visits_moving", "hidden_5s", "leader_swap", "pass_behind"),
    *("pass_behind_pillar", "passers_by", "reacts_blocks", "reacts_curious", "reacts_makes_way"),
    *("reacts_surprised", "reacts_wary", "same_uniform", "sitting", "stop_and_talk", "street_evening"),
    *("turn_while_hidden", "visitors_in_turn", "waits_for_robot"),
)
"""Scenarios of the library for training."""

_VALIDATED: Final = 7  # every seventh run is for validation, with all seeds of its scenario
_LIBRARY_SEEDS: Final = 6
_UNITS: Final = 64
_BATCH: Final = 512
_RATE: Final = 2e-3
_DECAY: Final = 1e-3
_LEAST_SAMPLES: Final = 2 * _BATCH
_LEAST_LOG, _MOST_LOG = -5.0, 1.0  # limits of the logarithm of a deviation per second [m/s]
_VARIANTS: Final = 2  # number of noisy copies of each instant


class WalkData(NamedTuple):
    """Inputs (N, INPUTS), and offsets (N, 5, 2) [m] from the straight path, NaN where unknown."""

    inputs: NDArray[np.float32]
    offsets: NDArray[np.float32]


class MotionData(NamedTuple):
    """Samples for training, and instants for validation."""

    training: WalkData
    validation: Sequence[WalkSample]


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionTraining(Specification[MotionData]):
    """The predictor `learned` uses this network.

    The training data are walks of people in random worlds and in scenarios of the library, without images: a
    path with the errors of a tracker, and where the person is 1 to 5 s later.
    """

    HINT = "`python -m benchmarks.prediction` evaluates it on unseen scenes"

    sequences: Annotated[
        int, Field(ge=10, le=10_000, alias="worlds", description="Number of random worlds.")
    ] = 400
    epochs: Annotated[int, Field(ge=1, le=10_000, description="Number of training epochs.")] = 30

    def tasks(self, out: Path) -> Tasks:
        """Simulate the worlds and the scenarios."""
        folder = sample_folder(out, Path(__file__), Path(__file__).with_name("walks.py"))
        tasks = [
            SampleTask(folder / f"{name}-{seed}.npz", collect_library, (name, seed))
            for seed in range(_LIBRARY_SEEDS)
            for name in SCENARIOS
        ]
        seeds = range(FIRST_WORLD, FIRST_WORLD + self.sequences)
        tasks += [SampleTask(folder / f"world-{seed}.npz", collect_world, (seed,)) for seed in seeds]
        is_left_out = [number % _VALIDATED == 0 for number in range(len(tasks))]
        return Split(
            [task for task, is_out in zip(tasks, is_left_out, strict=True) if not is_out],
            [task for task, is_out in zip(tasks, is_left_out, strict=True) if is_out],
        )

    def load(self, tasks: Tasks) -> MotionData:
        """Read the walks, and make samples of them."""
        rng = np.random.default_rng(0)
        training = [
            _data(sample) for sample in _samples([task.path for task in tasks.training] * _VARIANTS, rng)
        ]
        parts = [np.concatenate(part) for part in zip(*training, strict=True)]
        if not parts or len(parts[0]) < _LEAST_SAMPLES:
            raise BadInput(f"fewer than {_LEAST_SAMPLES} samples of walks; use more worlds")
        return MotionData(WalkData(*parts), list(_samples([task.path for task in tasks.validation], rng)))

    def fit(self, data: MotionData) -> Mapping[str, MotionNetwork]:
        """Minimise the negative log-likelihood of the offsets, and calibrate the deviations."""
        rng = np.random.default_rng(0)
        optimiser = Optimiser(_loss, _initial(rng), decay=_DECAY, averages=True)
        for epoch in range(self.epochs):
            rate = _RATE * 0.5 * (1.0 + np.cos(np.pi * epoch / self.epochs))
            rows = shuffled(len(data.training.inputs), _BATCH, rng)
            optimiser.run(((data.training.inputs[at], data.training.offsets[at]), rate) for at in rows)
        network = _network(optimiser.weights, np.ones(len(KNOTS_S), np.float32))
        scale = np.sqrt(np.nanquantile(_distances(network, data.validation), 0.95, axis=0) / ELLIPSE_95)
        scenes = (
            f"{self.sequences} random worlds from seed {FIRST_WORLD}, and {len(SCENARIOS)} scenarios with "
            f"{_LIBRARY_SEEDS} seeds"
        )
        about = {
            "trained on": f"{len(data.training.inputs)} samples of {scenes}",
            "training": f"{self.epochs} epochs",
        }
        return {f"{MODEL}.npz": _network(optimiser.weights, scale.astype(np.float32), about)}

    def evaluate(self, model: MotionNetwork, data: MotionData) -> Mapping[str, str]:
        """Measure errors and the share in the 95 % ellipse on the validation split."""
        errors, inside = _errors(model, data.validation), _distances(model, data.validation)
        return {
            f"validation, {after_s:g} s": f"{np.nanmean(error):.2f} m, {100 * share:.1f} % in the ellipse"
            for after_s, error, share in zip(
                KNOTS_S, errors.T, (inside <= ELLIPSE_95).sum(0) / np.isfinite(inside).sum(0), strict=True
            )
        }


def _samples(paths: Sequence[Path], rng: np.random.Generator) -> Iterator[WalkSample]:
    for path in paths:
        yield from samples_of(Walks.load(path), rng)


def _data(sample: WalkSample) -> WalkData:
    people = sample.people
    straight = people.position_m[:, None] + people.velocity_m_s[:, None] * KNOTS_S[:, None]
    offsets = (sample.later_m - straight) @ axes(people.velocity_m_s)
    return WalkData(inputs_of(people), offsets.astype(np.float32))


def _initial(rng: np.random.Generator) -> Weights:
    sizes = (INPUTS, _UNITS, _UNITS, OUTPUTS)
    names = zip(("first", "second", "last"), sizes[:-1], sizes[1:], strict=True)
    weights = {name: he_weights(rng, (inputs + 1, outputs), inputs) for name, inputs, outputs in names}
    weights["last"] *= np.float32(0.1)  # begin near the straight path
    return weights


def _loss(weights: Weights, batch: Any, _: jax.Array) -> tuple[jax.Array, dict[str, jax.Array]]:
    """Return the negative log-likelihood of offsets with normal errors along and across the path."""
    values, offsets = batch
    for name in ("first", "second"):
        values = jax.nn.relu(values @ weights[name][:-1] + weights[name][-1])
    outputs = (values @ weights["last"][:-1] + weights["last"][-1]).reshape(len(values), len(KNOTS_S), 4)
    knots = jnp.asarray(KNOTS_S)[:, None]
    is_known = jnp.isfinite(offsets)
    log = jnp.clip(outputs[..., 2:], _LEAST_LOG, _MOST_LOG)
    off = jnp.where(is_known, offsets / knots - outputs[..., :2], 0.0)
    losses = jnp.where(is_known, log + 0.5 * jnp.square(off * jnp.exp(-log)), 0.0)
    loss = losses.sum() / is_known.sum()
    return loss, {"loss": loss}


def _network(
    weights: Mapping[str, NDArray[np.float32]],
    scale: NDArray[np.float32],
    about: Mapping[str, str] | None = None,
) -> MotionNetwork:
    layers = weights["first"], weights["second"], weights["last"]
    return MotionNetwork(layers=layers, scale=scale, about=about or {})


def _distances(network: MotionNetwork, samples: Sequence[WalkSample]) -> NDArray[np.float64]:
    """Return squared Mahalanobis distances (N, 5) of the true places."""
    return np.concatenate(
        [squared_mahalanobis(network.predict(one.people, KNOTS_S), one.later_m) for one in samples]
    )


def _errors(network: MotionNetwork, samples: Sequence[WalkSample]) -> NDArray[np.float64]:
    """Return distances (N, 5) [m] of the true places."""
    predicted = [network.predict(one.people, KNOTS_S).mean_m - one.later_m for one in samples]
    return np.asarray(np.linalg.norm(np.concatenate(predicted), axis=2))
