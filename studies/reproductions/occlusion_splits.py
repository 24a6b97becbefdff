"""Which examples are learned from and which are tested with: at random, and scenario by scenario."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from peopleboy.studies.training.occlusion_pairs import PairSamples, accuracy
from peopleboy.studies.training.samples import Split
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES

PAIRS = 121
"""How many pairs the thesis has; with their mirror images, 242 examples."""
TRAINING_SHARE = 0.6


@dataclass(frozen=True, slots=True)
class LearnedSplit:
    """What came of one way to build weak classifiers, with two splits of the examples. Shares in percent.

    Attributes:
        held_out: right on the rest of examples that were split at random, as in the thesis.
        unseen: right on scenarios that nothing was learned from.
        table: learned from the random split.
    """

    held_out: float
    unseen: float
    table: LearnedTable


def random_split(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Draw as many pairs as the thesis has, and learn from 60 % of them.

    The same occlusion may be on both sides.

    Source: thesis, section 7.4.
    """
    rows = rng.permutation(len(examples))[:PAIRS]
    cut = round(TRAINING_SHARE * len(rows))
    return Split(examples.take(rows[:cut]), examples.take(rows[cut:]))


def split_by_scenario(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Draw scenarios until they have 60 % of the pairs, learn from these, and test with the others.

    One is left to test with, unless there is but one, even if the others have less.
    """
    names = np.unique(examples.scenario)
    is_learned = np.zeros(len(examples), np.bool_)
    for row in rng.permutation(len(names))[: max(1, len(names) - 1)]:
        if is_learned.sum() >= TRAINING_SHARE * len(examples):
            break
        is_learned |= examples.scenario == names[row]
    return Split(examples.take(is_learned), examples.take(~is_learned))


def learn_split(
    examples: PairSamples, uses: tuple[str, ...], most: int, rounds: int, rng: np.random.Generator
) -> LearnedSplit:
    """Learn from one split of each kind.

    Features that are 0 in all examples to learn from tell nothing: half of all answers are right then.

    Args:
        examples: all there are.
        uses: names of the features to learn from.
        most: how many of them a weak classifier may add up.
        rounds: of boosting; a single feature is one weak classifier, and boosting has nothing to add to it.
        rng: draws the splits.
    """
    from peopleboy.studies.training.occlusion import boost  # only learning needs scikit-learn

    right, tables = [], []
    for split in (random_split(examples, rng), split_by_scenario(examples, rng)):
        rounds_of = 1 if len(uses) == 1 else rounds
        features, is_front = split.training.mirror()
        if features[:, [FEATURES.index(name) for name in uses]].any():
            table = boost(features, is_front, most=most, uses=uses, rounds=rounds_of)
            right.append(accuracy(table, split.validation))
        else:
            table = LearnedTable(scale=dict.fromkeys(FEATURES, 1.0), classifiers=())
            right.append(50.0)
        tables.append(table)
    return LearnedSplit(right[0], right[1], tables[0])
