"""Units of work about who is in front of whom: examples, and learning from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.training.occlusion_learning.example_splits import learn_split
from peopleboy.studies.training.occlusion_learning.occlusion_pairs import PairExample, collect
from peopleboy.studies.training.occlusion_learning.pair_task import examples_of, plain_pairs
from peopleboy.studies.training.occlusion_learning.train_occlusion import LEAST


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
    """Learn from examples that are split at random, and scenario by scenario, and test on the rest.

    Attributes:
        uses: names of the features.
        most: how many of them a weak classifier may add up.
        rounds: of boosting.
        split: number of the splits, from 0.
        examples: to split.
        whose: the tracker that measured them.
    """

    uses: tuple[str, ...]
    most: int
    rounds: int
    split: int
    examples: tuple[PairExample, ...]
    whose: Setting
    is_timing: bool = False

    @property
    def key(self) -> str:
        """What is learned from how many examples, and the split."""
        uses = f"{','.join(self.uses)} by {self.most}"
        pairs = f"{len(self.examples)} pairs of {self.whose.key}"
        return f"learn {uses} | {pairs}, {self.rounds} rounds | {self.split}"

    def run(self) -> Result:
        """Learn and test.

        Source: thesis, section 7.4.
        """
        if len(self.examples) < LEAST:
            return {"held out": math.nan, "unseen scenarios": math.nan, "best": []}
        rng = stream(self.split, "occlusion.split")
        found = learn_split(self.examples, self.uses, self.most, self.rounds, rng)
        return {
            "held out": found.held_out,
            "unseen scenarios": found.unseen,
            "best": [weak.weights for weak in found.table.classifiers[:10]],
        }
