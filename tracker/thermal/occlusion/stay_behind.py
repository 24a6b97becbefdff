"""The thesis's way with hidden people: they are where their occluder is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import MotionConfig, StayBehindConfig, TrackerConfig
from peopleboy.tracker.thermal.contour.likelihood import head_share, seen_shares
from peopleboy.tracker.thermal.occlusion.depth_order import Surroundings
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.thermal.particles import VW
from peopleboy.tracker.thermal.reidentification import most_alike_and_nearest
from peopleboy.tracker.thermal.tracked_person import FORGET_S, TrackedPerson, hidden, moved_on, seen
from peopleboy.tracker.thermal.whereabouts import Regions

KEPT_FRAMES = 8  # thesis, section 7.3


@dataclass(frozen=True, slots=True)
class StayBehind:
    """Who is hidden stays with its occluder; its samples are kept for a few frames, and penalised by nobody.

    Source: thesis, section 7.3.
    """

    config: TrackerConfig
    hiding: StayBehindConfig

    def motion_of(self, person: TrackedPerson) -> MotionConfig:  # noqa: ARG002
        """Move everybody alike."""
        return self.config.motion

    def keeps_off(self, person: TrackedPerson) -> bool:
        """Penalise those who are seen."""
        return not person.is_hidden

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: Surroundings,
        view: FrameView,
        rng: np.random.Generator,  # noqa: ARG002
    ) -> TrackedPerson:
        """Call a person hidden whose head is, and suppose it where its occluder is."""
        occluder = surroundings.occluder(belief.estimate, self.config)
        if occluder is None:
            return seen(person, belief, None, view, self.config)
        shares = seen_shares(surroundings.image, belief.estimate, view.model.probes)
        if head_share(shares) > 1 - self.hiding.head_covered:
            return seen(person, belief, occluder.id, view, self.config)
        return replace(hidden(person, view), belief=belief, shown=occluder.shown, occluder=occluder.id)

    def searches(self, person: TrackedPerson) -> bool:
        """Keep the samples for a few frames."""
        return person.hidden_frames <= KEPT_FRAMES

    def remembers_lost(self, person: TrackedPerson) -> bool:  # noqa: ARG002
        """Remember only who was hidden."""
        return False

    def whereabouts(
        self, person: TrackedPerson, others: Sequence[TrackedPerson], view: FrameView
    ) -> NDArray[np.float64]:
        """Suppose a person where its occluder is; once that is gone, let it go on as it went."""
        occluder = next((other for other in others if other.id == person.occluder), None)
        if occluder is not None:
            return occluder.shown
        state = moved_on(person.shown, view)
        state[VW:] = 0.0
        return state

    def can_compare(self, found: TrackedPerson, lost: TrackedPerson) -> bool:  # noqa: ARG002
        """Decide at once."""
        return True

    def recognised(
        self,
        found: TrackedPerson,
        lost: Sequence[TrackedPerson],
        view: FrameView,  # noqa: ARG002
    ) -> TrackedPerson | None:
        """Take the nearest, if it is also the most alike."""
        return most_alike_and_nearest(found, lost)

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:  # noqa: ARG002
        """Show everybody who is not forgotten."""
        return person.hidden_s <= FORGET_S
