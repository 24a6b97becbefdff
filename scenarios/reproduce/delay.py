"""How soon a person is detected: thesis, section 5.3."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.reproduce.delay_units import DelayUnit
from scenarios.reproduce.experiment import Chart, Done, Line, Samples, missing
from scenarios.reproduce.plan import Plan
from scenarios.reproduce.settings import Setting
from scenarios.reproduce.units import FilmUnit, Unit

RATE_HZ = 15


@dataclass(frozen=True, slots=True)
class Delay:
    """Frames until somebody in plain view is detected, by a tracker that has just been switched on.

    Attributes:
        suites: data sets with one person, taken together.
        trackers: who is tried, by the name of the line.
    """

    suites: Sequence[str]
    trackers: Mapping[str, Setting]
    id: str = "section-5.3"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films first, then who sees them."""
        films = [FilmUnit(play, plan.cache) for name in self.suites for play in plan.suites[name]]
        return missing(films, done) or missing(
            [
                unit
                for r in range(plan.repeats)
                for who in self.trackers
                for unit in self._units(plan, who, r)
            ],
            done,
        )

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Take the means over all starts, repeat by repeat."""
        return {Line("one person", who): self._figures(plan, done, who) for who in self.trackers}

    def _units(self, plan: Plan, who: str, repeat: int) -> Iterator[DelayUnit]:
        for name in self.suites:
            for play in plan.suites[name]:
                yield DelayUnit(play, plan.cache, self.trackers[who], repeat)

    def _figures(self, plan: Plan, done: Done, who: str) -> dict[str, NDArray[np.float64]]:
        rows = []
        for repeat in range(plan.repeats):
            results = [done[unit.key] for unit in self._units(plan, who, repeat)]
            needed = [frames for result in results for frames in result["needed"]]
            starts = sum(result["starts"] for result in results)
            frames = float(np.mean(needed)) if needed else float("nan")
            rows.append((frames, frames / RATE_HZ, 100 * len(needed) / max(starts, 1)))
        return dict(zip(("frames", "s", "found in 2 s [%]"), np.array(rows).T, strict=True))
