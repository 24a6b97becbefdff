"""The trackers by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.occlusion.learned_order import shipped_order
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.thermal.variants import (
    FOOTAGE,
    PAPER,
    PEOPLEBOY,
    THESIS,
    THESIS_COLOUR,
    THESIS_OCCLUSION,
)
from peopleboy.tracker.track import Track


class Tracker(Protocol):
    """Whatever turns frames into tracks."""

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...


@runtime_checkable
class Explains(Protocol):
    """A tracker that tells more than its tracks."""

    @property
    def explanation(self) -> object:
        """What it believes beyond the tracks of the last frame; others draw it by its type."""
        ...


def explanation_of(tracker: Tracker) -> object:
    """Ask a tracker what it believes beyond its tracks; None where it tells nothing."""
    return tracker.explanation if isinstance(tracker, Explains) else None


TRACKERS: Mapping[str, TrackerConfig] = {
    "peopleboy": PEOPLEBOY,
    "learned": PEOPLEBOY,
    "footage": FOOTAGE,
    "thesis": THESIS_OCCLUSION,
    "thermal": THESIS,
    "colour": THESIS_COLOUR,
    "paper": PAPER,
}
"""Each tracker's settings by name; the first is the default. `learned` also has a learned order in depth."""

DEFAULT_TRACKER = "peopleboy"
FOOTAGE_TRACKER = "footage"


def make_tracker(name: str, rng: np.random.Generator) -> PeopleTracker:
    """Make the tracker of that name.

    Raises:
        BadInput: an unknown name.
    """
    if name not in TRACKERS:
        raise BadInput(f"unknown tracker {name!r}; there are: {', '.join(TRACKERS)}")
    return PeopleTracker(TRACKERS[name], rng, shipped_order() if name == "learned" else None)
