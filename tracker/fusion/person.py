"""One person, as heat, depth and colour tell together."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.told import Told
from peopleboy.tracker.panoramic.people.floor_motion import Motion
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.rgbd.people.looks import similarity
from peopleboy.tracker.track import FloorPlace, Status

TALL_M: Final = 1.72
WIDE_M: Final = 0.42
SPAN_M: Final = 0.48

_BEST_FIRST: Final = (Status.TRACKED, Status.PARTLY_OCCLUDED, Status.TOTALLY_OCCLUDED)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Person:
    """Somebody of whom at least one of the trackers has told.

    Attributes:
        id: number of the fused track; negative of a guest, of whom it is not decided who it is.
        motion: place and velocity in the room.
        heat, depth: ids of the tracks in the thermal and in the depth image that are, or were last, its own.
        warm, deep: what these tell in this frame; None for nothing.
        is_peeked: whether it was found where it was expected in the depth image of this frame.
        tall_m, wide_m, span_m: [m] height, and width of the torso and with the arms.
        looks: (BINS,) histogram of colours; None before any were seen in the light.
        looked: how often these were seen.
        strange: frames in a row in which it looked otherwise.
        born_s, seen_s, looked_s: [s] when it was born, last seen, and last known by its looks.
        looked_m: (2,) where that was in the room; None for nowhere.
    """

    id: int
    motion: Motion
    heat: int | None = None
    depth: int | None = None
    warm: Told | None = None
    deep: Told | None = None
    is_peeked: bool = False
    tall_m: float = TALL_M
    wide_m: float = WIDE_M
    span_m: float = SPAN_M
    looks: Floats | None = None
    looked: int = 0
    strange: int = 0
    born_s: float
    seen_s: float
    looked_s: float = -math.inf
    looked_m: Floats | None = None

    @property
    def told(self) -> tuple[Told, ...]:
        """What is told of the person in this frame."""
        return tuple(one for one in (self.warm, self.deep) if one is not None)

    @property
    def is_seen(self) -> bool:
        """Whether the person is seen in this frame."""
        return self.is_peeked or any(one.is_seen for one in self.told)

    @property
    def is_guest(self) -> bool:
        """Whether it is not decided who this is."""
        return self.id < 0

    @property
    def status(self) -> Status:
        """How well the tracker that sees the person best does."""
        told = (one.status for one in self.told)
        best = min(told, key=_BEST_FIRST.index, default=Status.TOTALLY_OCCLUDED)
        is_found = self.is_peeked and best is Status.TOTALLY_OCCLUDED
        return Status.PARTLY_OCCLUDED if is_found else best

    def later(self, dt_s: float, config: FusionConfig) -> Person:
        """Give the person after it has walked on; nobody has told of it yet."""
        motion = self.motion.later(dt_s, config.restlessness)
        if not self.is_seen:
            motion = motion.slowed(dt_s, config.slow_s)
        return replace(self, motion=motion, warm=None, deep=None, is_peeked=False)

    def with_depth(self, told: Told, time_s: float, config: FusionConfig) -> Person:
        """Take in what the tracker by depth tells."""
        person = replace(self, depth=told.id, deep=told)
        if not told.is_seen:
            return person
        if told.is_clear or self.depth is None:
            person = person._measured(told, 1.0 if self.depth is None else config.learned, config)
        person = person._looking(told, time_s, config)
        return replace(person, motion=self._placed(told, config), seen_s=time_s)

    def with_heat(self, told: Told, time_s: float, config: FusionConfig) -> Person:
        """Take in what the thermal tracker tells."""
        person = replace(self, heat=told.id, warm=told)
        return replace(person, motion=self._placed(told, config), seen_s=time_s) if told.is_seen else person

    def named(self, other: Person) -> Person:
        """Give who is here, and is told of so, the number, the measures and the looks of another."""
        return replace(
            self,
            id=other.id,
            looks=other.looks,
            looked=other.looked,
            tall_m=other.tall_m,
            wide_m=other.wide_m,
            span_m=other.span_m,
            born_s=other.born_s,
            strange=0,
        )

    def floor_place(self, pose: RobotPose, shared_m: float) -> FloorPlace:
        """Tell where the person stands in the robot's frame.

        Args:
            pose: of the robot in the room.
            shared_m: [m] error that all images of a person have in common.
        """
        x, y = pose.locate(self.motion.place_m).tolist()
        covariance = pose.turned(self.motion.place_m2) + np.eye(2) * shared_m**2
        (xx, xy), (_, yy) = covariance.tolist()
        return FloorPlace(position_m=(x, y), covariance_m2=(xx, xy, yy))

    def _placed(self, told: Told, config: FusionConfig) -> Motion:
        further_m = config.clear_m if told.is_clear else config.partly_m
        return self.motion.corrected(told.place_m, told.error_m2 + np.eye(2) * further_m**2)

    def _measured(self, told: Told, share: float, config: FusionConfig) -> Person:
        """Learn height and width."""
        tall = self.tall_m if told.tall_m is None else self.tall_m + share * (told.tall_m - self.tall_m)
        if not told.is_clear:
            return replace(self, tall_m=tall)
        span = (
            self.span_m if told.span_m is None else self.span_m + config.learned * (told.span_m - self.span_m)
        )
        return replace(self, tall_m=tall, span_m=span)

    def _looking(self, told: Told, time_s: float, config: FusionConfig) -> Person:
        """Learn looks, but not those of somebody else."""
        if told.looks is None:
            return self
        if self.looks is None or self.strange >= config.relearn_frames:
            return replace(
                self, looks=told.looks, looked=1, looked_s=time_s, looked_m=told.place_m, strange=0
            )
        if similarity(self.looks, told.looks) < config.least_own:
            return replace(self, strange=self.strange + 1)
        looked = self.looked + 1
        looks = self.looks + max(config.learned, 1.0 / looked) * (told.looks - self.looks)
        return replace(self, looks=looks, looked=looked, looked_s=time_s, looked_m=told.place_m, strange=0)


def newborn(number: int, told: Told, time_s: float) -> Person:
    """Begin a person where a tracker tells of one."""
    motion = Motion.begin(told.place_m, told.error_m2)
    return Person(id=number, motion=motion, born_s=time_s, seen_s=time_s)
