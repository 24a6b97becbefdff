"""Depth order by the learned classifier: pairwise votes, and order from front to back."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from peopleboy.tracker.reproductions.contour.contour_config import DepthOrderConfig
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import ORDERS, ExpectedPerson, Leads, Order
from peopleboy.tracker.reproductions.contour.occlusion.learned_table import TABLES, LearnedTable
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import (
    FEATURES,
    Features,
    Pairs,
    overlapping_pairs,
    pair_features,
)
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView

LEARNED: Final = "learned"


@dataclass(frozen=True, slots=True, eq=False)
class LearnedOrder:
    """Compares people by the votes of the weak classifiers.

    Attributes:
        weights: (T, 6) of the features, unscaled; their sign includes the parity.
        threshold: (T,) above which a classifier votes against the first person.
        importance: (T,) sums to 1.
        remembers_feet: whether feet are taken from the last full visibility, or from the contour.
    """

    weights: Features
    threshold: Features
    importance: Features
    remembers_feet: bool = True

    @classmethod
    def build(cls, table: LearnedTable, *, remembers_feet: bool = True) -> "LearnedOrder":
        """Make it from a table."""
        weak = table.classifiers
        scale = np.array([table.scale[name] for name in FEATURES])
        weights = np.array([[w.weights.get(name, 0.0) for name in FEATURES] for w in weak]) / scale
        parity = np.array([w.parity for w in weak], dtype=np.float64)
        importance = np.array([w.importance for w in weak])
        return cls(
            parity[:, None] * weights,
            parity * np.array([w.threshold for w in weak]),
            importance / importance.sum(),
            remembers_feet,
        )

    def votes(self, features: Features) -> Features:
        """Return the sums of votes (P,) on pairs with features (P, 6): 1 all for, -1 all against the first.

        Source: thesis, algorithm 5, output.
        """
        is_for = features @ self.weights.T < self.threshold
        votes: Features = np.where(is_for, self.importance, -self.importance).sum(axis=1)
        return votes

    def lead(self, features: Features) -> Features:
        """Return the lead (P,) of the first person: 1 certainly in front, -1 certainly behind, 0 unknown.

        The mirrored pair has the opposite lead: thresholds are seldom exactly 0, so that plain votes could
        put both of two people in front. Ours; the thesis evaluates one direction only.
        """
        return (self.votes(features) - self.votes(-features)) / 2

    def __call__(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
        """Return the lead (M, M) of row over column for people (M,) whose boxes overlap.

        All pairs at once cost hardly more than one.
        """
        pairs = overlapping_pairs(np.array([figure.state for figure in figures]))
        leads = np.zeros((len(figures), len(figures)))
        features = features_of(figures, pairs, view, remembers_feet=self.remembers_feet)
        leads[pairs[:, 0], pairs[:, 1]] = self.lead(features)
        return leads - leads.T


def features_of(
    figures: Sequence[ExpectedPerson], pairs: Pairs, view: FrameView, *, remembers_feet: bool
) -> Features:
    """Measure the features (P, 6) of pairs (P, 2) among people (M,)."""
    states = np.array([figure.state for figure in figures])
    models = [figure.person.appearance for figure in figures]
    feet = [figure.person.foot for figure in figures] if remembers_feet else None
    return pair_features(states, models, pairs, view, feet)


@cache
def shipped_order(tracker: str, *, remembers_feet: bool = True) -> LearnedOrder:
    """Return the shipped order that was trained for a tracker.

    Trackers measure contours and colours in different units, so that each needs its own table.

    Raises:
        BadInput: there is no such table.
    """
    return LearnedOrder.build(LearnedTable.load(TABLES / f"{tracker}.yaml"), remembers_feet=remembers_feet)


def make_order(config: DepthOrderConfig) -> Order | None:
    """Return a tracker's method of comparison; None if it has none."""
    if config.order == LEARNED:
        return shipped_order(config.table, remembers_feet=config.remembers_feet)
    return None if config.order is None else ORDERS[config.order]
