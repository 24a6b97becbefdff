"""The learned classifier at work: who of two people is in front, and everybody from front to back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.occlusion.depth_order import ExpectedPerson
from peopleboy.tracker.thermal.occlusion.learned_table import TABLES, LearnedTable
from peopleboy.tracker.thermal.occlusion.pair_features import (
    FEATURES,
    Features,
    Pairs,
    overlapping_pairs,
    pair_features,
)
from peopleboy.tracker.thermal.particle_filter import FrameView


@dataclass(frozen=True, slots=True, eq=False)
class LearnedOrder:
    """Compares people by the votes of the weak classifiers.

    Attributes:
        weights: (T, 6) of the features, unscaled; their sign holds the parity.
        threshold: (T,) above which a classifier votes against the one.
        importance: (T,) sums to 1.
    """

    weights: Features
    threshold: Features
    importance: Features

    @classmethod
    def build(cls, table: LearnedTable) -> LearnedOrder:
        """Lay a table out for quick use."""
        weak = table.classifiers
        scale = np.array([table.scale[name] for name in FEATURES])
        weights = np.array([[w.weights.get(name, 0.0) for name in FEATURES] for w in weak]) / scale
        parity = np.array([w.parity for w in weak], dtype=np.float64)
        importance = np.array([w.importance for w in weak])
        return cls(
            parity[:, None] * weights,
            parity * np.array([w.threshold for w in weak]),
            importance / importance.sum(),
        )

    def votes(self, features: Features) -> Features:
        """Add up the votes (P,) on pairs with these features (P, 6): 1 all for, -1 all against the one.

        Source: thesis, algorithm 5, output.
        """
        is_for = features @ self.weights.T < self.threshold
        votes: Features = np.where(is_for, self.importance, -self.importance).sum(axis=1)
        return votes

    def lead(self, features: Features) -> Features:
        """Tell how clearly (P,) the one is in front: 1 surely, -1 surely behind, 0 unknown.

        The mirrored pair has the opposite lead: thresholds are seldom exactly 0, and the plain votes could
        call both of two people the front one. Ours; the thesis asks in one direction only.
        """
        return (self.votes(features) - self.votes(-features)) / 2

    def __call__(self, one: ExpectedPerson, other: ExpectedPerson, view: FrameView) -> float:
        """Compare two people: positive if the one is in front, negative if the other is."""
        return float(self._leads((one, other), np.array([[0, 1]]), view)[0])

    def leads(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Features:
        """Compare all people (M,) whose boxes overlap: the lead (M, M) of the row's over the column's.

        All pairs at once cost hardly more than one. `sorted_by_lead` makes an order of it.
        """
        pairs = overlapping_pairs(np.array([figure.state for figure in figures]))
        leads = np.zeros((len(figures), len(figures)))
        leads[pairs[:, 0], pairs[:, 1]] = self._leads(figures, pairs, view)
        return leads - leads.T

    def _leads(self, figures: Sequence[ExpectedPerson], pairs: Pairs, view: FrameView) -> Features:
        return self.lead(features_of(figures, pairs, view))


def features_of(figures: Sequence[ExpectedPerson], pairs: Pairs, view: FrameView) -> Features:
    """Measure the features (P, 6) of pairs (P, 2) among people (M,)."""
    states = np.array([figure.state for figure in figures])
    models = [figure.person.looks for figure in figures]
    return pair_features(states, models, pairs, view, [figure.person.foot for figure in figures])


@cache
def shipped_order(tracker: str = "peopleboy") -> LearnedOrder:
    """Give the order that was learned for the tracker of that name, and comes with it.

    Trackers measure contours and colours in different units, so that each needs a table of its own.
    """
    return LearnedOrder.build(LearnedTable.load(TABLES / f"{tracker}.yaml"))


def sorted_by_lead(lead: NDArray[np.floating]) -> tuple[int, ...]:
    """Sort M people from front to back by their leads over each other.

    Whoever nobody else is in front of comes first, and so on with the rest. Where leads go round in a circle,
    whom the fewest are in front of comes first; then whose leads over the rest add up to more; then the
    lower number. So the result never depends on the sequence of the comparisons.

    Args:
        lead: (M, M) of the row's person over the column's; 0 where they do not overlap, or nobody knows.

    Source: thesis, section 7.1, which leaves circles open.
    """
    rest = list(range(len(lead)))
    order: list[int] = []
    while rest:
        among = lead[np.ix_(rest, rest)]
        behind = (among < 0).sum(axis=1)
        first = min(range(len(rest)), key=lambda i: (behind[i], -among[i].sum(), rest[i]))
        order.append(rest.pop(first))
    return tuple(order)
