"""Examples of one scene as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.foreground_learning.random_scene import random_scene
from peopleboy.studies.training.window_learning.window_examples import collect_windows
from peopleboy.tracker.frame import DEPTH


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowTask:
    """Play a scene, and keep examples of it.

    Attributes:
        folder: of the examples.
        scenario: of the library; empty for a scene drawn at random.
        seed: of scene and run.
        has_jitter: whether windows are also taken a little off, and mirrored.
    """

    folder: str
    scenario: str = ""
    seed: int
    has_jitter: bool = True
    size: int = 1

    @property
    def name(self) -> str:
        """Which scene."""
        return f"{self.scenario or 'scene'}_{self.seed}"

    @property
    def path(self) -> Path:
        """File of the examples."""
        return Path(self.folder) / f"{self.name}.npz"

    def __call__(self, tell: Tell) -> None:  # noqa: ARG002
        """Collect them."""
        collect_windows(self._scene(), self.seed, has_jitter=self.has_jitter).save(self.path)

    def _scene(self) -> Scenario:
        if self.scenario:
            return load_scenario(self.scenario)
        data = random_scene(self.seed, DEPTH)
        return parse_scenario(data, source=data["name"], folder=Path())
