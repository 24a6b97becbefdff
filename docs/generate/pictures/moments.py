"""Moments of runs for pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple, dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.scripted import Stand
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation
from peopleboy.tracker.trackers import CONTOUR_TRACKER, make_tracker

CROSSING = ("crossing_2", 3)
"""Scenario and seed: nina, who is near, walks in front of olaf, who is farther away."""


def ticks(
    scenario: str | Scenario, seed: int, frames: int, tracker: str = CONTOUR_TRACKER
) -> Iterator[tuple[SimulatedWorld, Tick]]:
    """Yield the first ticks of a scenario with a standing robot, as in `peopleboy run`."""
    played = load_scenario(scenario) if isinstance(scenario, str) else scenario
    with SimulatedWorld(played.world(seed)) as world:
        eyes = make_tracker(tracker, seed)
        for tick in closed_loop(world, eyes, Stand(), frames):
            yield world, tick


def world_at(scenario: str, seed: int, time_s: float) -> SimulatedWorld:
    """Return a world advanced to a time; the caller closes it."""
    config = load_scenario(scenario).world(seed)
    world = SimulatedWorld(config)
    for _ in range(round(time_s * config.control_hz)):
        world.step(0.0, 0.0)
    return world


def explained(tick: Tick) -> ContourExplanation:
    """Return the contour tracker's explanation at a tick."""
    assert isinstance(tick.explanation, ContourExplanation)
    return tick.explanation


def state_of(tick: Tick, track: int) -> NDArray[np.float64]:
    """Return a track's contour as a state (9,)."""
    return np.array(astuple(explained(tick).ellipses[track]))


@dataclass(slots=True)
class History:
    """Ground truth and track of one person over time."""

    time_s: list[float] = field(default_factory=list)
    visible: list[float] = field(default_factory=list)
    status: list[str] = field(default_factory=list)

    def add(self, tick: Tick, person: str, track: int) -> None:
        """Add a tick."""
        self.time_s.append(tick.truth.time_s)
        self.visible += [one.visible_fraction for one in tick.truth.people if one.name == person]
        found = [one.status.value for one in tick.tracks if one.id == track]
        self.status.append(found[0] if found else "no track")
