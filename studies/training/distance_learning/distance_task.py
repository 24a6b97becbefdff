"""Collecting examples of one run as a task, whose result is plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.distance_learning.distance_examples import collect


@dataclass(frozen=True, slots=True)
class DistanceTask:
    """Watch a scenario with one seed, and keep what is measured of the people.

    Attributes:
        scenario, seed: what is run.
        key: of all that its images depend on.
    """

    scenario: str
    seed: int
    key: str
    size: int = 1

    @property
    def name(self) -> str:
        """Which run, and of which version of the scenario."""
        return f"{self.scenario}-{self.seed}-{self.key}"

    def __call__(self, tell: Tell) -> dict[str, Any]:  # noqa: ARG002
        """Collect them."""
        return collect(self.scenario, self.seed)
