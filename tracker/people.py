"""The trackers by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np

from bad_input import BadInput
from tracker.appearance.config import FAR_AFFINE, ColourConfig
from tracker.config import InteractionConfig, LooksConfig, OcclusionConfig
from tracker.frame import Frame
from tracker.particles import Particles
from tracker.several import PeopleTracker
from tracker.single import SinglePersonTracker
from tracker.track import Track
from tracker.variants import FOOTAGE, PAPER, PEOPLEBOY, THESIS


class Tracker(Protocol):
    """Whatever turns frames into tracks."""

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...

    @property
    def particles(self) -> Mapping[int, Particles]:
        """The samples by track id; key 0 is the detector's cloud."""
        ...


_SEVERAL = replace(
    PEOPLEBOY,
    person=replace(PEOPLEBOY.person, floor=0.2),
    interaction=InteractionConfig(
        detector_penalty=1e-9, detector_overlap=0.3, penalty=8.0, occluded_penalty=0.0
    ),
    colour=ColourConfig(
        representation="moments1", sharpness=0.05, frames=30, affine=FAR_AFFINE, parallax=0.157
    ),
    looks=LooksConfig(),
    occlusion=OcclusionConfig(
        is_handled=True,
        removes_front=True,
        growth=1.2,
        keeps_velocity=True,
        hidden_noise=1.0,
        remembers_lost=True,
        shown_s=1.0,
    ),
)

TRACKERS: Mapping[str, Callable[[np.random.Generator], Tracker]] = {
    "peopleboy": lambda rng: PeopleTracker(_SEVERAL, rng),
    "footage": lambda rng: SinglePersonTracker(FOOTAGE, rng),
    "thermal": lambda rng: PeopleTracker(THESIS, rng),
    "thesis": lambda rng: SinglePersonTracker(THESIS, rng),
    "paper": lambda rng: SinglePersonTracker(PAPER, rng),
}
"""Each tracker's maker by name; the first is the default."""

DEFAULT_TRACKER = "peopleboy"


def make_tracker(name: str, rng: np.random.Generator) -> Tracker:
    """Make the tracker of that name.

    Raises:
        BadInput: an unknown name.
    """
    if name not in TRACKERS:
        raise BadInput(f"unknown tracker {name!r}; there are: {', '.join(TRACKERS)}")
    return TRACKERS[name](rng)
