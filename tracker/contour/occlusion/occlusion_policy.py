"""What a tracker asks about people who are hidden or lost, whoever answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.contour.box_interaction import Regions
from peopleboy.tracker.contour.contour_config import (
    MotionConfig,
    StayBehindConfig,
    TrackerConfig,
    WalkOnConfig,
)
from peopleboy.tracker.contour.gallery import most_alike_and_nearest
from peopleboy.tracker.contour.measurement.likelihood import head_share, seen_shares
from peopleboy.tracker.contour.occlusion.coasting import WalkOn
from peopleboy.tracker.contour.occlusion.depth_order import OrderContext
from peopleboy.tracker.contour.particle_filter import Belief, FrameView
from peopleboy.tracker.contour.particles import VW
from peopleboy.tracker.contour.tracked_person import FORGET_S, TrackedPerson, hidden, moved_on, seen

# The thesis's way with hidden people: they are where their occluder is.

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
        surroundings: OrderContext,
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


class OcclusionPolicy(Protocol):
    """Supposes where people are who are not seen, and says when that begins and ends."""

    def motion_of(self, person: TrackedPerson) -> MotionConfig:
        """Return how a person's samples move."""
        ...

    def keeps_off(self, person: TrackedPerson) -> bool:
        """Return whether a person's samples are penalised for overlapping the others."""
        ...

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: OrderContext,
        view: FrameView,
        rng: np.random.Generator,
    ) -> TrackedPerson:
        """Return how well a person is seen after its samples were weighed, and where it is supposed to be."""
        ...

    def searches(self, person: TrackedPerson) -> bool:
        """Return whether a hidden person's samples go on looking for it."""
        ...

    def remembers_lost(self, person: TrackedPerson) -> bool:
        """Return whether a person who is given up without having been hidden is remembered."""
        ...

    def whereabouts(
        self, person: TrackedPerson, others: Sequence[TrackedPerson], view: FrameView
    ) -> NDArray[np.float64]:
        """Suppose where a person is (9,) whose samples no longer look for it."""
        ...

    def can_compare(self, found: TrackedPerson, lost: TrackedPerson) -> bool:
        """Return whether enough is seen of a newly found person to say whether it is one who was lost."""
        ...

    def recognised(
        self, found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView
    ) -> TrackedPerson | None:
        """Find the one of those lost, at least one, who is a newly found person; None if nobody is."""
        ...

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:
        """Return whether a hidden person, supposed in a region (4,) [px] in the image, is shown."""
        ...


def make_policy(config: TrackerConfig) -> OcclusionPolicy:
    """Make the policy that a tracker's settings ask for."""
    hiding = config.occlusion
    return WalkOn(config, hiding) if isinstance(hiding, WalkOnConfig) else StayBehind(config, hiding)
