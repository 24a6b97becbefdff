"""The trackers by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np

from bad_input import BadInput
from tracker.config import InteractionConfig
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


_SEVERAL = replace(PEOPLEBOY, interaction=InteractionConfig(detector_penalty=1e-9, detector_overlap=0.3))

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
