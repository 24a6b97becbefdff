"""What came of a step in all of many worlds, as gymnasium's vector environments have it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.environments.join_infos import Infos, join_infos
from peopleboy.scenarios.environments.judging.episode_figures import Figures
from peopleboy.scenarios.environments.judging.episodes import Verdicts
from peopleboy.scenarios.environments.judging.rewards import TERMS
from peopleboy.sim.shapes.joined_tables import Numbers


class StepResults:
    """Those of B worlds, in some of which an episode goes on, and begins in the others.

    Attributes:
        rewards: (B,).
        terminations, truncations: (B,).
    """

    def __init__(self, worlds: int) -> None:
        self.rewards = np.zeros(worlds)
        self.terminations, self.truncations = np.zeros((2, worlds), np.bool_)
        self._terms = np.zeros((worlds, len(TERMS)))
        self._truths, self._events = np.empty((2, worlds), object)

    def take(self, numbers: Numbers, verdicts: Verdicts) -> None:
        """Take in what came of the step in some of the worlds."""
        self.rewards[numbers], self._terms[numbers] = verdicts.rewards, verdicts.terms
        self.terminations[numbers], self.truncations[numbers] = verdicts.terminations, verdicts.truncations
        for row, number in enumerate(numbers.tolist()):
            self._truths[number], self._events[number] = verdicts.truths[row], verdicts.events[row]

    def begin(self, number: int, info: Infos) -> None:
        """Take in what an episode begins with in one of the worlds."""
        self._truths[number], self._events[number] = info["truth"], info["events"]

    def infos(self, seeds: list[int], metrics: list[Figures | None]) -> Infos:
        """Make what `join_infos` makes of B infos of single environments.

        Args:
            seeds: of each.
            metrics: None where an episode goes on.
        """
        have = np.ones(len(seeds), np.bool_)
        terms = {name: self._terms[:, k].copy() for k, name in enumerate(TERMS)}
        columns = {
            "truth": self._truths,
            "reward": _with_flags(terms, have),
            "events": self._events,
            "seed": np.array(seeds),
        }
        found = _with_flags(columns, have)
        if any(figures is not None for figures in metrics):
            found |= join_infos([None if figures is None else {"metrics": figures} for figures in metrics])
        return found


def _with_flags(columns: dict[str, Any], have: NDArray[np.bool_]) -> Infos:
    """Put beside each column who has it."""
    return {
        key: each for name, column in columns.items() for key, each in ((name, column), (f"_{name}", have))
    }
