"""Crops otherwise than they were filmed, each time they are learned from."""

from __future__ import annotations

from typing import Final

import jax
import jax.numpy as jnp

_STILL: Final = 0.15  # of crops, whose motion is not shown
_SWIFTER: Final = 0.2  # deviation of the logarithm of how much moves
_NOISY: Final = 0.5  # of crops
_MOST_NOISE: Final = 0.25  # of deviations of the crop
_SLOPE: Final = 0.25  # deviation of greys that rise from one side to the other
_COVERED: Final = 0.2  # of crops, in part
_TALL: Final = (0.1, 0.5)  # shares of the crop that cover it
_WIDE: Final = (0.1, 0.6)


def varied(planes: jax.Array, key: jax.Array) -> jax.Array:
    """Give crops (N, rows, columns, 3) with other motion, noise and slopes of greys, some partly covered."""
    keys = iter(jax.random.split(key, 8))
    count, rows, columns, _ = planes.shape
    grey, change, inside = planes[..., :1], planes[..., 1:2], planes[..., 2:]

    def share(*more: int) -> jax.Array:
        return jax.random.uniform(next(keys), (count, *(more or (1,)), 1, 1))

    def deviates(*shape: int) -> jax.Array:
        return jax.random.normal(next(keys), (count, *shape))

    moving = jnp.where(share() < _STILL, 0.0, change * jnp.exp(_SWIFTER * deviates(1, 1, 1)))
    drawn = share(2)[..., None]
    noise = jnp.where(drawn[:, 0] < _NOISY, _MOST_NOISE * drawn[:, 1], 0.0) * deviates(rows, columns, 1)
    slope = _SLOPE * deviates(2, 1, 1, 1)
    down, right = jnp.linspace(-1.0, 1.0, rows)[:, None, None], jnp.linspace(-1.0, 1.0, columns)[:, None]
    other = grey + (noise + slope[:, 0] * down + slope[:, 1] * right) * inside
    is_covered = _cover(share(5)[..., None], rows, columns)
    other = jnp.where(is_covered, deviates(1, 1, 1) * inside, other)
    return jnp.concatenate([other, jnp.where(is_covered, 0.0, moving), inside], axis=3)


def _cover(drawn: jax.Array, rows: int, columns: int) -> jax.Array:
    """Tell which pixels (N, rows, columns, 1) something covers, by numbers (N, 5, 1, 1, 1) from 0 to 1."""
    high, wide = (
        size * (least + (most - least) * drawn[:, k])
        for k, (size, (least, most)) in enumerate(((rows, _TALL), (columns, _WIDE)))
    )
    off_row = jnp.abs(jnp.arange(rows)[:, None, None] - rows * drawn[:, 2])
    off_column = jnp.abs(jnp.arange(columns)[:, None] - columns * drawn[:, 3])
    return (off_row < 0.5 * high) & (off_column < 0.5 * wide) & (drawn[:, 4] < _COVERED)
