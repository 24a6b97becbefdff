"""What was found in a frame: on the floor, with its size, and whether it looks like a human."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.tracker.frame import Floats
from peopleboy.tracker.rgbd.detection.pre_detection import PreDetection
from peopleboy.tracker.rgbd.people.look_at import Body


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
