"""The scene models that are compared, by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final, Protocol

from peopleboy.sim.random_streams import stream
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.scene_model.printed.printed_config import VARIANTS, PrintedConfig
from peopleboy.tracker.scene_model.printed.printed_model import PrintedSceneModel
from peopleboy.tracker.scene_model.scene import Happening, VistaScene
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel

MEAN, MPIX, TRACK, ADAPT = "MEAN", "MPIX", "TRACK", "ADAPT"
"""As printed."""

ROBUST, NO_HEAT = "robust", "robust, without heat"
"""Ours, and ours without the thermal image."""

PRINTED: Final = (MEAN, MPIX, TRACK, ADAPT)
OURS: Final = (ROBUST, NO_HEAT)


class Watches(Protocol):
    """Whatever turns frames into scenes."""

    def update(self, frame: Frame) -> VistaScene:
        """Take in the next frame."""
        ...

    def finish(self) -> tuple[Happening, ...]:
        """Tell what was held back."""
        ...


def _printed(config: PrintedConfig) -> Watches:
    return PrintedSceneModel(config, stream(0, "scene.particles"))


def _robust(config: SceneConfig) -> Watches:
    return SceneModel(config)


CHOICES: Final[dict[str, Callable[[], Watches]]] = {
    **{name: partial(_printed, VARIANTS[name.lower()]) for name in PRINTED},
    ROBUST: partial(_robust, SceneConfig()),
    NO_HEAT: partial(_robust, SceneConfig(people=PeopleMaskConfig(has_heat=False))),
}
