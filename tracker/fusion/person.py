"""One person, as heat, depth and colour tell together."""

from __future__ import annotations

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

_BEST_FIRST: Final = (Status.TRACKED, Status.PARTLY_OCCLUDED, Status.TOTALLY_OCCLUDED)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Person:
    """Somebody whom at least one of the trackers has told of.

    Attributes:
        id: number of the fused track.
        motion: place and velocity in the room.
        heat, depth: ids of the tracks in the thermal and in the depth image that are, or were last, its own.
        warm, deep: what these tell in this frame; None for nothing.
        tall_m, wide_m: [m] height, and width of the torso.
        looks: (BINS,) histogram of colours; None before any were seen in the light.
        born_s, seen_s: [s] when it was born, and last seen.
    """

    id: int
    motion: Motion
    heat: int | None = None
    depth: int | None = None
    warm: Told | None = None
    deep: Told | None = None
    tall_m: float = TALL_M
    wide_m: float = WIDE_M
    span_m: float = 0.48
    looks: Floats | None = None
    peeked: bool = False
    strange: int = 0
    born_s: float
    seen_s: float

    @property
    def told(self) -> tuple[Told, ...]:
        """What is told of the person in this frame."""
        return tuple(one for one in (self.warm, self.deep) if one is not None)

    @property
    def is_seen(self) -> bool:
        """Whether any tracker sees the person in this frame."""
        return self.peeked or any(one.is_seen for one in self.told)

    @property
    def status(self) -> Status:
        """How well the tracker that sees the person best does."""
        told = (one.status for one in self.told)
        found = min(told, key=_BEST_FIRST.index, default=Status.TOTALLY_OCCLUDED)
        return Status.PARTLY_OCCLUDED if self.peeked and found is Status.TOTALLY_OCCLUDED else found

    def later(self, dt_s: float, config: FusionConfig) -> Person:
        """Give the person after it has walked on; nobody has told of it yet."""
        motion = self.motion.later(dt_s, config.restlessness)
        if not self.is_seen:
            motion = motion.slowed(dt_s, config.slow_s)
        return replace(self, motion=motion, warm=None, deep=None, peeked=False)

    def with_depth(self, told: Told, time_s: float, config: FusionConfig) -> Person:
        """Take in what the depth image tells."""
        person = replace(self, depth=told.id, deep=told)
        if not told.is_seen:
            return person
        error = told.error_m2 + np.eye(2) * (config.deep_m if told.is_clear else config.partly_m) ** 2
        tall, looks = self.tall_m, self.looks
        if told.tall_m is not None and (told.is_clear or self.depth is None):
            tall += (config.learned if self.depth is not None else 1.0) * (told.tall_m - tall)
        if told.looks is not None and told.is_clear:
            alike = 1.0 if looks is None else similarity(looks, told.looks)
            strange = self.strange + 1 if alike < config.least_own else 0
            person = replace(person, strange=strange)
            if looks is None or strange > config.relearn:
                looks = told.looks
            elif strange == 0:
                looks = looks + config.learned * (told.looks - looks)
        span = self.span_m
        if told.is_clear and told.span_m is not None:
            span += config.learned * (told.span_m - span)
        motion = self.motion.corrected(told.place_m, error)
        return replace(person, span_m=span, motion=motion, tall_m=tall, looks=looks, seen_s=time_s)

    def with_heat(self, told: Told, time_s: float, config: FusionConfig) -> Person:
        """Take in what the thermal image tells."""
        person = replace(self, heat=told.id, warm=told)
        if not told.is_seen:
            return person
        error = told.error_m2 + np.eye(2) * (config.warm_m if told.is_clear else config.partly_m) ** 2
        motion = self.motion.corrected(told.place_m, error)
        return replace(person, motion=motion, seen_s=time_s)

    def named(self, other: Person) -> Person:
        """Give who is here, and is told of so, with the number, the measures and the looks of another."""
        return replace(
            self, id=other.id, looks=other.looks, tall_m=other.tall_m, wide_m=other.wide_m,
            span_m=other.span_m, born_s=other.born_s, strange=0,
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


def newborn(number: int, told: Told, time_s: float) -> Person:
    """Begin a person where a tracker tells of one."""
    motion = Motion.begin(told.place_m, told.error_m2)
    return Person(id=number, motion=motion, born_s=time_s, seen_s=time_s)
