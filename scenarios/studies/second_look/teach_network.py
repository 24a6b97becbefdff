"""Teaching the network of the second look, with JAX and Optax; a running tracker does without them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Final, NamedTuple

import numpy as np

from peopleboy.bad_input import BadInput

try:
    import jax
    import jax.numpy as jnp
    import optax
except ImportError:
    raise BadInput("teaching the second look needs JAX and Optax: pip install jax optax") from None

from peopleboy.scenarios.studies.second_look.looks import NOBODY, SOMEBODY, LookExamples
from peopleboy.scenarios.studies.second_look.vary_crops import varied
from peopleboy.tracker.proposals.crops import SCORES, Planes, planes_of
from peopleboy.tracker.proposals.placing import OFFSETS
from peopleboy.tracker.proposals.second_look import LAYERS, SCALES, USUAL, SecondLook, shapes

Weights = dict[str, jax.Array]
Array = jax.Array | Planes

_BATCH: Final = 64
_RATE: Final = 1.5e-3
_WARM_UP: Final = 300  # batches
_DECAY: Final = 0.02  # of kernels, in a batch, of the rate
_LEFT_OUT: Final = 0.4  # of units, in each batch others (Srivastava et al., JMLR 2014)
_PLACES: Final = 0.5  # weight of where people are, beside whether
_FAR: Final = 2.0  # units from which on it does not matter how much farther off a place is (Huber)
_FOLLOWED: Final = 0.002  # least share of a batch in the weights that are kept (Polyak and Juditsky 1992)
_SOON: Final = 9.0  # batches, so that the n-th has a share of 9 / (9 + n) at first
_TOLD: Final = 200  # batches
_LAST: Final = 0.1  # weights of the last layer, beside He's


class Losses(NamedTuple):
    """How far off a batch was.

    Attributes:
        whether: negative logarithm of the likelihood, a proposal.
        where: units off, in the mean over what tells places.
    """

    whether: jax.Array
    where: jax.Array


def first_weights(rng: np.random.Generator) -> dict[str, Planes]:
    """Draw a network that knows nothing (He et al., ICCV 2015): it says what the first look does."""
    weights: dict[str, Planes] = {}
    for name, shape in shapes().items():
        drawn = rng.standard_normal(shape) * math.sqrt(2.0 / shape[0]) if len(shape) > 1 else np.zeros(shape)
        weights[name] = drawn.astype(np.float32)
    weights["last"] *= np.float32(_LAST)
    weights["line"] = np.array([1.0, 0.0], np.float32)
    return weights


def teach_network(
    looks: LookExamples, rng: np.random.Generator, *, rounds: int, say: Callable[[str], None]
) -> SecondLook:
    """Teach a network on what was proposed: each is seen once a round, in half of the batches mirrored.

    What is kept are the weights of the last batches, in the mean.

    Raises:
        BadInput: there is too little to learn from.
    """
    batches = rounds * (len(looks.overlap) // _BATCH)
    if not batches:
        raise BadInput(f"{len(looks.overlap)} proposals, at least {_BATCH} are needed; take more worlds")
    first = first_weights(rng)
    line = first.pop("line")
    weights = {name: jnp.asarray(array) for name, array in first.items()}
    optimiser = _optimiser(batches)
    step = jax.jit(partial(_step, optimiser))
    state, kept, total = optimiser.init(weights), weights, np.zeros(2)
    keys = jax.random.split(jax.random.key(int(rng.integers(2**31))), batches)
    for number, batch in enumerate(_batches(looks, rng, rounds), 1):
        weights, state, kept, losses = step(
            weights, state, kept, planes_of(batch.crops), batch, keys[number - 1], _followed(number)
        )
        total += [float(losses.whether), float(losses.where)]
        if number % _TOLD == 0:
            say(f"{number} of {batches} batches: loss {total[0] / _TOLD:.3f}, places {total[1] / _TOLD:.3f}")
            total[:] = 0.0
    return SecondLook({**{name: np.asarray(array) for name, array in kept.items()}, "line": line})


def told(weights: Weights, planes: Array, numbers: Array, left: Array | float = 1.0) -> jax.Array:
    """Tell (N, 5) of crops (N, 64, 48, 3) with numbers (N, 9), as `SecondLook.told` does.

    All is in units of `SCALES`, off `USUAL`.

    Args:
        weights: of the network.
        planes: crops.
        numbers: of the proposals.
        left: (N, 128) by what units are multiplied.
    """
    here = jnp.asarray(planes)
    for layer, (side, stride, depth) in enumerate(LAYERS):
        edge = side // 2
        seen = jax.lax.conv_general_dilated(
            here,
            weights[f"kernel{layer}"].reshape(side, side, -1, depth),
            (stride, stride),
            [(edge, edge), (edge, edge)],
            dimension_numbers=("NHWC", "HWIO", "NHWC"),
        )
        here = jax.nn.relu(seen + weights[f"bias{layer}"])
    flat = jnp.concatenate([here.reshape(len(here), -1), numbers], axis=1)
    units = left * jax.nn.relu(flat @ weights["all"] + weights["all_bias"])
    last = jnp.asarray(units @ weights["last"] + weights["last_bias"])
    return last.at[:, 0].add(SCORES * numbers[:, 0])


def loss(
    weights: Weights, planes: Array, batch: LookExamples, left: Array | float
) -> tuple[jax.Array, Losses]:
    """Give the loss of a batch, and the two that make it."""
    last = told(weights, planes, batch.numbers, left)
    is_person = batch.overlap >= SOMEBODY
    counts = is_person | (batch.overlap < NOBODY)
    likely = jnp.logaddexp(0.0, jnp.where(is_person, -last[:, 0], last[:, 0])) * counts
    off = jnp.abs(last[:, 1:] - (batch.offsets - USUAL[1:]) / SCALES[1:]) * is_person[:, None]
    bent = jnp.where(off < _FAR, 0.5 * off * off, _FAR * (off - 0.5 * _FAR))
    whether = likely.sum() / jnp.maximum(counts.sum(), 1)
    where = off.sum() / jnp.maximum(is_person.sum(), 1) / OFFSETS
    return likely.mean() + _PLACES * bent.mean(), Losses(whether, where)


def _step(
    optimiser: optax.GradientTransformation,
    weights: Weights,
    state: optax.OptState,
    kept: Weights,
    planes: jax.Array,
    batch: LookExamples,
    key: jax.Array,
    followed: float,
) -> tuple[Weights, optax.OptState, Weights, Losses]:
    for_crops, for_units = jax.random.split(key)
    units = weights["last"].shape[0]
    left = (jax.random.uniform(for_units, (len(planes), units)) >= _LEFT_OUT) / (1.0 - _LEFT_OUT)
    seen = varied(planes, for_crops)
    (_, losses), slopes = jax.value_and_grad(loss, has_aux=True)(weights, seen, batch, left)
    steps, state = optimiser.update(slopes, state, weights)
    weights = {name: array + steps[name] for name, array in weights.items()}
    kept = {name: array + followed * (weights[name] - array) for name, array in kept.items()}
    return weights, state, kept, losses


def _followed(number: int) -> float:
    """Give the share that weights after so many batches have in those that are kept: more at first."""
    return max(_FOLLOWED, _SOON / (_SOON + number))


def _optimiser(batches: int) -> optax.GradientTransformation:
    """Steps of a size of their own for each weight, ever smaller; kernels shrink (AdamW, ICLR 2019)."""
    rate = optax.warmup_cosine_decay_schedule(0.0, _RATE, min(_WARM_UP, batches // 2), batches)
    return optax.adamw(
        rate, weight_decay=_DECAY, mask=lambda weights: {name: w.ndim > 1 for name, w in weights.items()}
    )


def _batches(looks: LookExamples, rng: np.random.Generator, rounds: int) -> Iterator[LookExamples]:
    for _ in range(rounds):
        order = rng.permutation(len(looks.overlap))
        for begin in range(0, len(order) - _BATCH + 1, _BATCH):
            batch = looks.take(np.sort(order[begin : begin + _BATCH]))
            yield batch.mirrored() if rng.random() < 0.5 else batch
