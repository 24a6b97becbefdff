"""Optimiser of all networks: Adam with JAX and Optax, which are needed for training only."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
import optax
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Weights = dict[str, Any]
"""Arrays by name."""
Loss = Callable[[Weights, Any, jax.Array], tuple[jax.Array, dict[str, jax.Array]]]
"""Function of weights, a batch and a random key that returns the loss, and results to report by name."""

_LEAST_SHARE: Final = 0.002  # of the latest weights in the running average (Polyak and Juditsky 1992)
_WARM_UP: Final = 9.0  # at first the weights of step n have a share of 9 / (9 + n)


class Optimiser:
    """Optimiser of a network's weights.

    Attributes:
        steps: number of steps so far.
    """

    def __init__(
        self, loss: Loss, weights: Weights, *, seed: int = 0, decay: float = 0.0, averages: bool = False
    ) -> None:
        """Initialise the optimiser.

        Args:
            loss: loss to minimise.
            weights: initial weights.
            seed: seed of the random keys that are passed to the loss.
            decay: weight decay of matrices, relative to the learning rate (AdamW, ICLR 2019).
            averages: whether the result is a running average of the weights.
        """
        self.steps = 0
        self._weights: Weights = {name: jnp.asarray(array) for name, array in weights.items()}
        self._average: Weights = dict(self._weights) if averages else {}
        matrices = {name: array.ndim > 1 for name, array in self._weights.items()}
        adam = optax.chain(optax.scale_by_adam(), optax.add_decayed_weights(decay, matrices))
        self._state, self._key = adam.init(self._weights), jax.random.key(seed)

        def step(
            weights: Weights, average: Weights, state: optax.OptState, batch: Any, key: jax.Array, rates: Any
        ) -> tuple[Weights, Weights, optax.OptState, dict[str, jax.Array]]:
            rate, share = rates
            (_, results), slopes = jax.value_and_grad(loss, has_aux=True)(weights, batch, key)
            steps, state = adam.update(slopes, state, weights)
            weights = {name: array - rate * steps[name] for name, array in weights.items()}
            average = {name: kept + share * (weights[name] - kept) for name, kept in average.items()}
            return weights, average, state, results

        self._step = jax.jit(step)

    def step(self, batch: Any, rate: float) -> dict[str, jax.Array]:
        """Take a step on a batch with a learning rate, and return the results of the loss, computed later."""
        self.steps += 1
        key = jax.random.fold_in(self._key, self.steps)
        rates = rate, max(_LEAST_SHARE, _WARM_UP / (_WARM_UP + self.steps))
        results: dict[str, jax.Array]
        self._weights, self._average, self._state, results = self._step(
            self._weights, self._average, self._state, batch, key, rates
        )
        return results

    def run(self, batches: Iterable[tuple[Any, float]]) -> dict[str, float]:
        """Take a step on each batch with its learning rate, and return the mean results of the loss."""
        results = [self.step(batch, rate) for batch, rate in batches]
        return {name: float(np.mean([float(one[name]) for one in results])) for name in results[0]}

    @property
    def weights(self) -> dict[str, Floats]:
        """The weights, or their running average."""
        return {name: np.array(array) for name, array in (self._average or self._weights).items()}


def shuffled(count: int, size: int, rng: np.random.Generator) -> Iterator[NDArray[np.int64]]:
    """Yield the row numbers of full batches, in random order."""
    order = rng.permutation(count)
    for begin in range(0, count - size + 1, size):
        yield order[begin : begin + size]


def he_weights(rng: np.random.Generator, shape: tuple[int, ...], inputs: int) -> Floats:
    """Draw initial weights for rectified linear units (He et al., ICCV 2015)."""
    return (rng.standard_normal(shape) * math.sqrt(2.0 / inputs)).astype(np.float32)


def huber(off: jax.Array, linear_from: float) -> jax.Array:
    """Return the Huber loss: half the square, continued linearly beyond a threshold (Huber 1964)."""
    return jnp.where(off < linear_from, 0.5 * off * off, linear_from * (off - 0.5 * linear_from))
