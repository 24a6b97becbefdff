"""How far off the closer look is, in what it tells and in what boxes share."""

from __future__ import annotations

from typing import Final

import jax
import jax.numpy as jnp

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.teach_network import (
    Array,
    Lesson,
    Losses,
    Weights,
    bent,
    last_of,
)
from peopleboy.tracker.proposals.looks.closer_look import SCALES, USUAL, CloserLook

_SHARED: Final = 4.0  # weight of what boxes do not share
_UNITS: Final = 0.3  # weight of units off
_FAR: Final = 1.0  # units
_MOST: Final = 8.0  # of them: who is farther off is somebody else
_WRONG: Final = 12.0  # units, at most, by which boxes are told to share anything
_NOTHING: Final = 1e-9


def closer_look_loss(weights: Weights, planes: Array, batch: LookExamples, left: Array | float) -> Losses:
    """Give the losses of a batch: what boxes do not share (Yu et al., UnitBox 2016), and units off."""
    told = last_of(CloserLook.FORM, weights, planes, batch.numbers[:, 1:], left)
    off = jnp.abs(told - (batch.offsets - USUAL) / SCALES)
    shared = _iou(jnp.clip(told, -_WRONG, _WRONG) * SCALES + USUAL, jnp.asarray(batch.offsets))
    whole = _SHARED * (1.0 - shared) + _UNITS * jnp.minimum(bent(off, _FAR), _MOST).mean(axis=1)
    return Losses(whole.mean(), {"overlap": shared.mean(), "units off": off.mean()})


def _iou(one: jax.Array, other: jax.Array) -> jax.Array:
    """Give the IoU (N,) of boxes by their offsets (N, 4) from the same windows."""
    (low, high), (begin, end) = _corners(one), _corners(other)
    common = jnp.prod(jnp.maximum(jnp.minimum(high, end) - jnp.maximum(low, begin), 0.0), axis=1)
    either = jnp.prod(high - low, axis=1) + jnp.prod(end - begin, axis=1) - common
    return common / (either + _NOTHING)


def _corners(offsets: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Give two corners (N, 2), in heights of the window."""
    middle, top, height, half = offsets[:, 0], offsets[:, 1], jnp.exp(offsets[:, 2]), offsets[:, 3] / 2.0
    return jnp.stack([middle - half, top], axis=1), jnp.stack([middle + half, top + height], axis=1)


CLOSER_LOOK: Final = Lesson(CloserLook.FORM, closer_look_loss, left_out=0.2)
