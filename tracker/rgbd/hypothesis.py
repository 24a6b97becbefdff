"""One hypothesis: a person that the tracker believes in, or soon may."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.rgbd.floor_filter import FloorFilter
from peopleboy.tracker.rgbd.observation_model import Body
from peopleboy.tracker.rgbd.pre_detection import PreDetection
from peopleboy.tracker.track import Status


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hypothesis:
    """A person on the floor (SA eq. 4.17).

    Attributes:
        id: number of a track; 0 while nobody is believed to be there.
        place_m: (2,) forward, left in the robot's frame [m].
        velocity_m_s: (2,) smoothed.
        covariance_m2: (2, 2) of its error.
        body: what the person measures and looks like.
        filter: its particles.
        born_s, verified_s, seen_s: [s] when it was made, last verified, and last seen by detector or filter.
        verifications: how often, up to the number that makes a person of it.
        seen_through: frames in a row in which the camera saw what is behind.
        confidence: 0..1.
        status: whether the person is believed in, and how much of it is hidden.
        occluder: id of who hides it; None if nobody does.
    """

    id: int = 0
    place_m: Floats
    velocity_m_s: Floats
    covariance_m2: Floats
    body: Body
    filter: FloorFilter
    born_s: float
    verified_s: float
    seen_s: float
    verifications: int = 1
    seen_through: int = 0
    confidence: float = 0.5
    status: Status = Status.TENTATIVE
    occluder: int | None = None


# What was found in a frame: on the floor, with its size, and whether it looks like a human.


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detection:
    """Something of the size of a human.

    Attributes:
        found: in the depth image.
        place_m: (2,) forward, left in the robot's frame [m].
        body: what it measures and looks like.
        score: of its window, above 0 for a human.
        is_verified: whether it looks like a human.
    """

    found: PreDetection
    place_m: Floats
    body: Body
    score: float
    is_verified: bool
