"""Collecting examples as a task, whose result is plain data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.occlusion_learning.occlusion_pairs import PairExample, collect
from peopleboy.tracker.contour.contour_config import TrackerConfig


@dataclass(frozen=True, slots=True)
class PairTask:
    """Run a tracker through a scenario, and keep what it measured of people who overlap."""

    scenario: str
    seed: int
    tracker: str
    config: TrackerConfig
    size: int = 1

    @property
    def name(self) -> str:
        """Whose examples, of which run."""
        return f"{self.tracker} {self.scenario}-{self.seed}"

    def __call__(self, tell: Tell) -> dict[str, Any]:  # noqa: ARG002
        """Collect them."""
        return {"pairs": plain_pairs(collect(self.scenario, self.seed, self.config))}


def plain_pairs(found: Iterable[PairExample]) -> list[list[object]]:
    """Turn the examples of a run into plain data; its scenario and seed are left out."""
    return [[e.frame, e.one, e.other, bool(e.is_front), *e.features.tolist()] for e in found]


def examples_of(scenario: str, seed: int, pairs: Sequence[Sequence[Any]]) -> list[PairExample]:
    """Make examples out of it again, equal to the last digit."""
    return [
        PairExample(
            scenario=scenario,
            seed=seed,
            frame=frame,
            one=one,
            other=other,
            is_front=is_front,
            features=np.array(features),
        )
        for frame, one, other, is_front, *features in pairs
    ]
