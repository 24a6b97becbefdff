"""Units of work of the thesis on situation awareness: films in which things are moved."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.evaluations.scene_scores import watch_scene, with_preset


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneUnit:
    """Play a film once, and let scene models watch it.

    Attributes:
        scenario: of the library.
        seed: of the run.
        preset: of the depth camera.
        names: of the models.
        keeps_maps: whether the backgrounds are kept.
    """

    scenario: str
    seed: int
    preset: str
    names: tuple[str, ...]
    keeps_maps: bool = False
    is_timing: bool = False

    @property
    def key(self) -> str:
        """Film and models."""
        maps = " with maps" if self.keeps_maps else ""
        return f"scene {self.scenario}-{self.seed} {self.preset}{maps} | {', '.join(self.names)}"

    def run(self) -> Result:
        """Play and score."""
        scenario = with_preset(load_scenario(self.scenario), self.preset)
        return watch_scene(scenario, self.seed, self.names, keeps_maps=self.keeps_maps)
