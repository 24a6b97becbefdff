"""What came of a step in all of many worlds, as gymnasium's vector environments have it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.environments.episodes import Metrics, StepOutcomes
from peopleboy.scenarios.environments.rewards import TERMS
from peopleboy.sim.shapes.shape_table import Numbers

Infos = dict[str, Any]


def join_infos(infos: Sequence[Infos | None]) -> Infos:
    """Make arrays (B,) of B infos, at once where gymnasium's `VectorEnv` takes one after the other.

    Each key of any of them has an array of its values, and beside it, as `_key`, one of who has it; numbers
    are arrays of numbers, 0 for those who have none, dicts are joined in the same way, all else is objects.

    Args:
        infos: None for an environment that says nothing.
    """
    found: Infos = {}
    for key in dict.fromkeys(key for info in infos if info is not None for key in info):
        has = [info is not None and key in info for info in infos]
        values = [
            info[key] if is_there and info is not None else None
            for info, is_there in zip(infos, has, strict=True)
        ]
        first = values[has.index(True)]
        if isinstance(first, dict):
            found[key] = join_infos(values)
        else:
            found[key] = _array(values, first)
        found[f"_{key}"] = np.array(has)
    return found


def _array(values: list[Any], first: object) -> NDArray[Any]:
    if type(first) in (int, float, bool):
        return np.array([type(first)() if value is None else value for value in values])
    array = np.empty(len(values), object)
    for number, value in enumerate(values):
        array[number] = value
    return array


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

    def take(self, numbers: Numbers, outcomes: StepOutcomes) -> None:
        """Take in what came of the step in some of the worlds."""
        self.rewards[numbers], self._terms[numbers] = outcomes.rewards, outcomes.terms
        self.terminations[numbers], self.truncations[numbers] = outcomes.terminations, outcomes.truncations
        for row, number in enumerate(numbers.tolist()):
            self._truths[number], self._events[number] = outcomes.truths[row], outcomes.events[row]

    def begin(self, number: int, info: Infos) -> None:
        """Take in what an episode begins with in one of the worlds."""
        self._truths[number], self._events[number] = info["truth"], info["events"]

    def infos(self, seeds: list[int], metrics: list[Metrics | None]) -> Infos:
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
