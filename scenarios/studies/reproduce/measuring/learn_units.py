"""Units of work about who is in front of whom: examples, and learning from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.studies.occlusion_learning.occlusion_pairs import PairExample, collect, mirrored
from peopleboy.scenarios.studies.occlusion_learning.pair_task import examples_of, plain_pairs
from peopleboy.scenarios.studies.occlusion_learning.train_occlusion import PAIRS, accuracy
from peopleboy.scenarios.studies.reproduce.measuring.tracker_settings import Setting
from peopleboy.sim.random_streams import stream

TRAINING_SHARE = 0.6
LEAST = 20
"""Pairs with fewer of which nothing is learned."""


@dataclass(frozen=True, slots=True)
class PairUnit:
    """Run a tracker through a scenario, and keep what it measured of people who overlap."""

    scenario: str
    seed: int
    setting: Setting
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Whose examples, from where."""
        return f"pairs {self.scenario}-{self.seed} | {self.setting.key}"

    def run(self) -> Result:
        """Collect the examples."""
        return {"pairs": plain_pairs(collect(self.scenario, self.seed, self.setting.config()))}


def examples(unit: PairUnit, result: Result) -> list[PairExample]:
    """Make examples out of a unit's result."""
    return examples_of(unit.scenario, unit.seed, result["pairs"])


@dataclass(frozen=True, slots=True, eq=False)
class LearnUnit:
    """Draw as many examples as the thesis has, learn from 60 %, and test on the rest and elsewhere.

    Attributes:
        uses: names of the features.
        most: how many of them a weak classifier may add up.
        rounds: of boosting.
        split: number of the random split, from 0.
        training: examples to split.
        unseen: examples of other scenarios.
        whose: the tracker that measured them.
    """

    uses: tuple[str, ...]
    most: int
    rounds: int
    split: int
    training: tuple[PairExample, ...]
    unseen: tuple[PairExample, ...]
    whose: Setting
    is_timing: bool = False

    @property
    def key(self) -> str:
        """What is learned from how many examples, and the split."""
        count = f"{len(self.training)}+{len(self.unseen)}"
        uses = f"{','.join(self.uses)} by {self.most}"
        return f"learn {uses} | {count} pairs of {self.whose.key}, {self.rounds} rounds | {self.split}"

    def run(self) -> Result:
        """Learn and test.

        Source: thesis, section 7.4.
        """
        # Only here: what needs scikit-learn is not needed for anything else.
        from peopleboy.tracker.thermal.occlusion.boosting import train

        if len(self.training) < LEAST:
            return {"held out": math.nan, "unseen scenarios": math.nan, "best": []}
        order = stream(self.split, "reproduce.split").permutation(len(self.training))[:PAIRS]
        cut = round(TRAINING_SHARE * len(order))
        chosen, rest = ([self.training[i] for i in rows] for rows in (order[:cut], order[cut:]))
        table = train(*mirrored(chosen), most=self.most, uses=self.uses, rounds=self.rounds)
        return {
            "held out": accuracy(table, rest),
            "unseen scenarios": accuracy(table, self.unseen),
            "best": [weak.weights for weak in table.classifiers[:10]],
        }
