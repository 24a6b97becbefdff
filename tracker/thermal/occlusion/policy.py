"""What a tracker asks about people who are hidden or lost, whoever answers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import MotionConfig, TrackerConfig, WalkOnConfig
from peopleboy.tracker.thermal.occlusion.depth_order import Surroundings
from peopleboy.tracker.thermal.occlusion.stay_behind import StayBehind
from peopleboy.tracker.thermal.occlusion.walk_on import WalkOn
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.thermal.tracked_person import TrackedPerson
from peopleboy.tracker.thermal.whereabouts import Regions


class OcclusionPolicy(Protocol):
    """Supposes where people are who are not seen, and tells when that begins and ends."""

    def motion_of(self, person: TrackedPerson) -> MotionConfig:
        """Tell how a person's samples move."""
        ...

    def keeps_off(self, person: TrackedPerson) -> bool:
        """Tell whether a person's samples are penalised for overlapping the others."""
        ...

    def judge(
        self,
        person: TrackedPerson,
        belief: Belief,
        surroundings: Surroundings,
        view: FrameView,
        rng: np.random.Generator,
    ) -> TrackedPerson:
        """Tell how well a person is seen after its samples were weighed, and where it is supposed to be."""
        ...

    def searches(self, person: TrackedPerson) -> bool:
        """Tell whether a hidden person's samples go on looking for it."""
        ...

    def remembers_lost(self, person: TrackedPerson) -> bool:
        """Tell whether a person who is given up without having been hidden is remembered."""
        ...

    def whereabouts(
        self, person: TrackedPerson, others: Sequence[TrackedPerson], view: FrameView
    ) -> NDArray[np.float64]:
        """Suppose where a person is (9,) whose samples no longer look for it."""
        ...

    def can_compare(self, found: TrackedPerson, lost: TrackedPerson) -> bool:
        """Tell whether enough is seen of a newly found person to say whether it is one who was lost."""
        ...

    def recognised(
        self, found: TrackedPerson, lost: Sequence[TrackedPerson], view: FrameView
    ) -> TrackedPerson | None:
        """Find the one of those lost, at least one, who is a newly found person; None if nobody is."""
        ...

    def is_shown(self, person: TrackedPerson, region: Regions, view: FrameView) -> bool:
        """Tell whether a hidden person, supposed in a region (4,) [px] in the image, is shown."""
        ...


def make_policy(config: TrackerConfig) -> OcclusionPolicy:
    """Make the policy that a tracker's settings ask for."""
    hiding = config.occlusion
    return WalkOn(config, hiding) if isinstance(hiding, WalkOnConfig) else StayBehind(config, hiding)
