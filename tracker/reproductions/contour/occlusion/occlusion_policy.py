"""Policies for occluded and lost people: that of the thesis, and the choice of one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.box_interaction import Regions
from peopleboy.tracker.reproductions.contour.contour_config import (
    MotionConfig,
    StayBehindConfig,
    TrackerConfig,
    WalkOnConfig,
)
from peopleboy.tracker.reproductions.contour.gallery import most_alike_and_nearest
from peopleboy.tracker.reproductions.contour.measurement.likelihood import head_share, seen_shares
from peopleboy.tracker.reproductions.contour.occlusion.coasting import WalkOn
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import OrderContext
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, FrameView
from peopleboy.tracker.reproductions.contour.particles import VW
from peopleboy.tracker.reproductions.contour.tracked_person import (
    FORGET_S,
    TrackedPerson,
    hidden,
    moved_on,
    seen,
)

# The thesis's policy: occluded people are at their occluder.

KEPT_FRAMES = 8  # thesis, section 7.3


@dataclass(frozen=True, slots=True)
class StayBehind:
    """Occluded people stay at their occluder; their samples are kept for a few frames without penalty.

    Source: thesis, section 7.3.
    """

    config: TrackerConfig
    hiding: StayBehindConfig

    def motion_of(self, person: TrackedPerson) -> MotionConfig:  # noqa: ARG002
        """Use the same motion for everybody."""
        return self.config.motion

    def keeps_off(self, person: TrackedPerson) -> bool:
        """Penalise visible people."""
        return not person.is_hidden

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: OrderContext,
        view: FrameView,
        rng: np.random.Generator,  # noqa: ARG002
    ) -> TrackedPerson:
        """A person is occluded if its head is, and is then assumed to be at its occluder."""
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
        """Remember only occluded people."""
        return False

    def whereabouts(
        self, person: TrackedPerson, others: Sequence[TrackedPerson], view: FrameView
    ) -> NDArray[np.float64]:
        """Return the occluder's position; once the occluder is gone, continue with its motion."""
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
        """Return the nearest person, if that is also the most similar one."""
        return most_alike_and_nearest(found, lost)

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:  # noqa: ARG002
        """Output everybody who is not forgotten."""
        return person.hidden_s <= FORGET_S


OcclusionPolicy = StayBehind | WalkOn
"""Policy for people who are not visible: their assumed state, and when it starts and ends."""


def make_policy(config: TrackerConfig) -> OcclusionPolicy:
    """Make the policy of a tracker's settings."""
    hiding = config.occlusion
    return WalkOn(config, hiding) if isinstance(hiding, WalkOnConfig) else StayBehind(config, hiding)
