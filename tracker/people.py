"""The trackers by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from bad_input import BadInput
from tracker.frame import Frame
from tracker.occlusion.learned_order import shipped_order
from tracker.particles import Particles
from tracker.several import PeopleTracker
from tracker.track import Track
from tracker.variants import FOOTAGE, PAPER, PEOPLEBOY, THESIS, THESIS_COLOUR, THESIS_OCCLUSION


class Tracker(Protocol):
    """Whatever turns frames into tracks."""

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...

    @property
    def particles(self) -> Mapping[int, Particles]:
        """The samples by track id; key 0 is the detector's cloud."""
        ...


TRACKERS: Mapping[str, Callable[[np.random.Generator], Tracker]] = {
    "peopleboy": lambda rng: PeopleTracker(PEOPLEBOY, rng),
    "learned": lambda rng: PeopleTracker(PEOPLEBOY, rng, shipped_order()),
    "footage": lambda rng: PeopleTracker(FOOTAGE, rng),
    "thesis": lambda rng: PeopleTracker(THESIS_OCCLUSION, rng),
    "thermal": lambda rng: PeopleTracker(THESIS, rng),
    "colour": lambda rng: PeopleTracker(THESIS_COLOUR, rng),
    "paper": lambda rng: PeopleTracker(PAPER, rng),
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
