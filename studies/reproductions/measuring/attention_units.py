"""Units of work in which attention is directed to people."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.attention_focus import (
    watch_absence,
    watch_focus,
    watch_follower,
)


@dataclass(frozen=True, slots=True)
class FocusUnit:
    """Play a film, and look for its people in several ways.

    Attributes:
        scenario: of the library.
        seed: of the run.
        names: of the ways.
        most_s: [s] after which the film is cut.
    """

    scenario: str
    seed: int
    names: tuple[str, ...]
    most_s: float
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Film and ways."""
        return f"focus {self.scenario}-{self.seed} {self.most_s:g}s | {', '.join(self.names)}"

    def run(self) -> Result:
        """Play and look."""
        scenario = load_scenario(self.scenario)
        scenario = scenario.lasting(min(scenario.duration_s, self.most_s))
        return watch_focus(scenario, self.seed, self.names)


@dataclass(frozen=True, slots=True)
class AbsenceUnit:
    """Play a film in which somebody goes away and comes back, for several trackers.

    Attributes:
        scenario: of the library.
        seed: of the run.
        names: of the trackers.
    """

    scenario: str
    seed: int
    names: tuple[str, ...]
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Film and trackers."""
        return f"absence {self.scenario}-{self.seed} | {', '.join(self.names)}"

    def run(self) -> Result:
        """Play and track."""
        return watch_absence(load_scenario(self.scenario), self.seed, self.names)


@dataclass(frozen=True, slots=True)
class FollowUnit:
    """Let a robot follow somebody who goes away twice.

    Attributes:
        scenario: of the library.
        seed: of the run.
        tracker: its name.
    """

    scenario: str
    seed: int
    tracker: str
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Run and tracker."""
        return f"follow {self.scenario}-{self.seed} | {self.tracker}"

    def run(self) -> Result:
        """Drive."""
        return watch_follower(load_scenario(self.scenario), self.seed, self.tracker)
