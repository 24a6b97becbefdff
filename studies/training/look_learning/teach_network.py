"""Teaching a network that looks at crops, with JAX and Optax; a running tracker does without them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from typing import Final, NamedTuple, Protocol

import numpy as np

from peopleboy.bad_input import BadInput

try:
    import jax
    import jax.numpy as jnp
    import optax
except ImportError:
    raise BadInput("teaching a network needs JAX and Optax: pip install jax optax") from None

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.vary_crops import varied
from peopleboy.tracker.proposals.looks.crops import Planes, planes_of
from peopleboy.tracker.proposals.looks.network import Form

Weights = dict[str, jax.Array]
Array = jax.Array | Planes

_BATCH: Final = 64
_RATE: Final = 1.5e-3
_WARM_UP: Final = 300  # batches
_DECAY: Final = 0.02  # of kernels, in a batch, of the rate
_FOLLOWED: Final = 0.002  # least share of a batch in the weights that are kept (Polyak and Juditsky 1992)
_SOON: Final = 9.0  # batches, so that the n-th has a share of 9 / (9 + n) at first
_TOLD: Final = 200  # batches
_LAST: Final = 0.1  # weights of the last layer, beside He's


class Losses(NamedTuple):
    """How far off a batch was.

    Attributes:
        all: what is made small.
        shown: what is told of it while it is taught, by name.
    """

    all: jax.Array
    shown: dict[str, jax.Array]


class LookLoss(Protocol):
    """How far off a network is, by its weights and examples with their planes (N, rows, columns, 3)."""

    def __call__(self, weights: Weights, planes: Array, batch: LookExamples, left: Array | float) -> Losses:
        """Give the losses of a batch; units (N, units) are multiplied by what is left of them."""
        ...


class Lesson(NamedTuple):
    """What is taught.

    Attributes:
        form: of the network.
        loss: how far off it is.
        left_out: share of units, in each batch others (Srivastava et al., JMLR 2014).
    """

    form: Form
    loss: LookLoss
    left_out: float


def first_weights(form: Form, rng: np.random.Generator) -> dict[str, Planes]:
    """Draw a network that knows hardly anything (He et al., ICCV 2015)."""
    weights: dict[str, Planes] = {}
    for name, shape in form.shapes().items():
        drawn = rng.standard_normal(shape) * math.sqrt(2.0 / shape[0]) if len(shape) > 1 else np.zeros(shape)
        weights[name] = drawn.astype(np.float32)
    weights["last"] *= np.float32(_LAST)
    return weights


def teach_network(
    lesson: Lesson, looks: LookExamples, rng: np.random.Generator, *, rounds: int, say: Callable[[str], None]
) -> dict[str, Planes]:
    """Teach a network on examples: each is seen once a round, in half of the batches mirrored.

    Returns:
        The weights of the last batches, in the mean.

    Raises:
        BadInput: there is too little to learn from.
    """
    batches = rounds * (len(looks.overlap) // _BATCH)
    if not batches:
        raise BadInput(f"{len(looks.overlap)} examples, at least {_BATCH} are needed; take more worlds")
    weights = {name: jnp.asarray(array) for name, array in first_weights(lesson.form, rng).items()}
    step = partial(_step, lesson, batches)
    state, kept, total = _optimiser(batches).init(weights), weights, Counter[str]()
    keys = jax.random.split(jax.random.key(int(rng.integers(2**31))), batches)
    for number, batch in enumerate(_batches(looks, rng, rounds), 1):
        weights, state, kept, losses = step(
            weights, state, kept, planes_of(batch.crops), batch, keys[number - 1], _followed(number)
        )
        total.update({name: float(value) for name, value in losses.shown.items()})
        if number % _TOLD == 0:
            means = ", ".join(f"{name} {value / _TOLD:.3f}" for name, value in total.items())
            say(f"{number} of {batches} batches: {means}")
            total.clear()
    return {name: np.asarray(array) for name, array in kept.items()}


def last_of(
    form: Form, weights: Weights, planes: Array, numbers: Array, left: Array | float = 1.0
) -> jax.Array:
    """Give what the last layer says (N, told) of crops with numbers, as `CropNetwork.last` does.

    Args:
        form: of the network.
        weights: of it.
        planes: (N, rows, columns, 3) crops.
        numbers: (N, numbers) of the proposals.
        left: (N, units) by what units are multiplied.
    """
    here = jnp.asarray(planes)
    for layer, (side, stride, depth) in enumerate(form.layers):
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
    return jnp.asarray(units @ weights["last"] + weights["last_bias"])


def bent(off: jax.Array, far: float) -> jax.Array:
    """Give half of squares, that go on as lines from some units on (Huber 1964)."""
    return jnp.where(off < far, 0.5 * off * off, far * (off - 0.5 * far))


@partial(jax.jit, static_argnums=(0, 1))
def _step(
    lesson: Lesson,
    batches: int,
    weights: Weights,
    state: optax.OptState,
    kept: Weights,
    planes: jax.Array,
    batch: LookExamples,
    key: jax.Array,
    followed: float,
) -> tuple[Weights, optax.OptState, Weights, Losses]:
    def loss(weights: Weights) -> tuple[jax.Array, Losses]:
        losses = lesson.loss(weights, seen, batch, left)
        return losses.all, losses

    for_crops, for_units = jax.random.split(key)
    units, left_out = lesson.form.units, lesson.left_out
    left = (jax.random.uniform(for_units, (len(planes), units)) >= left_out) / (1.0 - left_out)
    seen = varied(planes, for_crops)
    (_, losses), slopes = jax.value_and_grad(loss, has_aux=True)(weights)
    steps, state = _optimiser(batches).update(slopes, state, weights)
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
