"""How far off the second look is, of whether somebody is there and where."""

from __future__ import annotations

from typing import Final

import jax.numpy as jnp

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.second_look_examples import NOBODY, SOMEBODY
from peopleboy.studies.training.look_learning.teach_network import (
    Array,
    Lesson,
    Losses,
    Weights,
    bent,
    last_of,
)
from peopleboy.tracker.proposals.looks.crops import SCORES
from peopleboy.tracker.proposals.looks.second_look import SCALES, USUAL, SecondLook
from peopleboy.tracker.proposals.placing import OFFSETS

_PLACES: Final = 0.5  # weight of where people are, beside whether
_FAR: Final = 2.0  # units from which on it does not matter how much farther off a place is


def second_look_loss(weights: Weights, planes: Array, batch: LookExamples, left: Array | float) -> Losses:
    """Give the losses of a batch: of log odds, and of offsets in units."""
    last = last_of(SecondLook.FORM, weights, planes, batch.numbers, left)
    score = last[:, 0] + SCORES * batch.numbers[:, 0]
    is_person = batch.overlap >= SOMEBODY
    counts = is_person | (batch.overlap < NOBODY)
    likely = jnp.logaddexp(0.0, jnp.where(is_person, -score, score)) * counts
    off = jnp.abs(last[:, 1:] - (batch.offsets - USUAL[1:]) / SCALES[1:]) * is_person[:, None]
    whether = likely.sum() / jnp.maximum(counts.sum(), 1)
    where = off.sum() / jnp.maximum(is_person.sum(), 1) / OFFSETS
    all_of_it = likely.mean() + _PLACES * bent(off, _FAR).mean()
    return Losses(all_of_it, {"log loss": whether, "units off": where})


SECOND_LOOK: Final = Lesson(SecondLook.FORM, second_look_loss, left_out=0.4)
