"""Experiments on telling who is in front: the thesis's tables 7.1 to 7.4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.learn_units import LearnUnit, PairUnit, examples
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.training.occlusion_learning.train_occlusion import SCENARIOS
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES
from peopleboy.tracker.contour.occlusion.weak_classifiers import weighted_sums

SHARE = "right [%]"
CLASSIFIERS, PAIRS = "weak classifiers", "pairs"
SCENES = (
    *SCENARIOS,
    "dark_crossing",
    "crowd_8",
    "turn_while_hidden",
    "hidden_2s_moving",
    "hall_visits",
    "corridor_patrol",
)
"""Where examples come from: those of the shipped tables, harder ones, and the films of data sets 3 and 4."""
TESTS = ("held out", "unseen scenarios")
TRACKERS = {"literal": Setting("thesis-occlusion"), "default": Setting("contour")}
"""Who measures the examples; the thesis says nothing of tests on other scenes than those it learned from."""


@dataclass(frozen=True, slots=True)
class Way:
    """A way to build weak classifiers.

    Attributes:
        name: as in the source's table.
        uses: names of the features.
        most: how many of them are added up.
    """

    name: str
    uses: tuple[str, ...] = FEATURES
    most: int = 2

    def unit(self, plan: Plan, done: Done, split: int, whose: Setting) -> LearnUnit:
        """Give the work of one split; the examples must have been collected."""
        found = (example for unit in pair_units(plan, whose) for example in examples(unit, done[unit.key]))
        return LearnUnit(self.uses, self.most, plan.rounds, split, tuple(found), whose)


@dataclass(frozen=True, slots=True)
class Learning:
    """Ways to build weak classifiers, side by side."""

    id: str
    ways: tuple[Way, ...]
    chart: Chart = "bars"
    plotted: tuple[str, ...] = (SHARE,)

    @property
    def groups(self) -> list[str]:
        """Names of all ways, whether or not a quick run tries them."""
        return [way.name for way in self.ways]

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Examples first, then what is learned from them."""
        pairs = [unit for whose in TRACKERS.values() for unit in pair_units(plan, whose)]
        lessons = (
            unit
            for whose in TRACKERS.values()
            for way in self._ways(plan)
            for unit in _splits(way, plan, done, whose)
        )
        return missing(pairs, done) or missing(lessons, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the share of right answers, split by split, and how many classifiers and pairs there are."""
        return {
            Line(way.name, f"{who}, {test}"): {
                CLASSIFIERS: np.array([float(len(weighted_sums(len(way.uses), way.most)))]),
                PAIRS: np.array(
                    [float(sum(len(done[unit.key]["pairs"]) for unit in pair_units(plan, whose)))]
                ),
                SHARE: np.array([done[unit.key][test] for unit in _splits(way, plan, done, whose)]),
            }
            for way in self._ways(plan)
            for who, whose in TRACKERS.items()
            for test in TESTS
        }

    def _ways(self, plan: Plan) -> list[Way]:
        return [way for way in self.ways if way.most <= (3 if plan.triplets else 2)]


@dataclass(frozen=True, slots=True)
class BestClassifiers:
    """The ten weak classifiers that are chosen first, with their weights."""

    id: str = "table-7.4"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()
    way: Way = Way("both")

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The same work as for table 7.1."""
        return Learning(self.id, (self.way,)).wants(plan, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the weights of the first split; NaN for features that a classifier does not use."""
        best = {who: done[self.way.unit(plan, done, 0, whose).key]["best"] for who, whose in TRACKERS.items()}
        return {
            Line(str(place), who): {name: np.array([weights.get(name, np.nan)]) for name in FEATURES}
            for who, chosen in best.items()
            for place, weights in enumerate(chosen, 1)
        }


def pair_units(plan: Plan, whose: Setting) -> list[PairUnit]:
    """List where a tracker's examples come from."""
    return [PairUnit(name, seed, whose) for seed in range(plan.pair_seeds) for name in SCENES]


def _pair_count(plan: Plan, done: Done, whose: Setting) -> int:
    return sum(len(done[unit.key]["pairs"]) for unit in pair_units(plan, whose))


def _splits(way: Way, plan: Plan, done: Done, whose: Setting) -> list[LearnUnit]:
    return [way.unit(plan, done, split, whose) for split in range(plan.splits)]
