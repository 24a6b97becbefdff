"""Units of work of the thesis on situation awareness: drives with a depth camera."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.drive_tracking import watch_drive, watch_legs
from peopleboy.tracker.frame import DEPTH


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveUnit:
    """Play a drive once, and let trackers watch it.

    Attributes:
        scenario: of the library.
        seed: of the run.
        names: of the trackers.
        scale: of the depth's noise.
        most_s: [s] after which the film is cut.
    """

    scenario: str
    seed: int
    names: tuple[str, ...]
    scale: float = 1.0
    most_s: float = 3600.0
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Film and trackers."""
        cut = f" {self.most_s:g}s" if self.most_s < 3600.0 else ""
        return f"drive {self.scenario}-{self.seed}{cut} noise {self.scale:g} | {', '.join(self.names)}"

    def run(self) -> Result:
        """Play and score."""
        scenario = load_scenario(self.scenario)
        scenario = scenario.lasting(min(scenario.duration_s, self.most_s))
        if self.scale != 1.0:
            scenario = scenario.with_cameras({DEPTH: {"kind": DEPTH, "scale": self.scale}})
        return watch_drive(scenario, self.seed, self.names)


@dataclass(frozen=True, slots=True)
class LegsUnit:
    """Follow a person by legs and by depth and colour at the same time.

    Attributes:
        scenario: of the library, played with seed 0.
        most_s: [s] after which the film is cut.
    """

    scenario: str
    most_s: float
    is_timing: bool = False

    @property
    def key(self) -> str:
        """The film."""
        return f"legs {self.scenario} {self.most_s:g}s"

    def run(self) -> Result:
        """Play and follow."""
        scenario = load_scenario(self.scenario)
        return watch_legs(scenario.lasting(min(scenario.duration_s, self.most_s)), 0)
