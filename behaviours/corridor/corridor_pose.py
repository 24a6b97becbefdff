"""Where the robot is in a corridor, or why nobody can tell."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from peopleboy.behaviours.dead_reckoning import Motion


@dataclass(frozen=True, slots=True, kw_only=True)
class Corridor:
    """The robot's place in a straight corridor.

    Attributes:
        offset_m: [m] how far the robot's origin is to the left of the centre line.
        heading_rad: [rad] direction of the robot's nose off the corridor's, positive to the left.
        width_m: [m] from wall to wall.
    """

    offset_m: float
    heading_rad: float
    width_m: float


@dataclass(frozen=True, slots=True)
class Unknown:
    """No corridor can be told.

    Attributes:
        reason: why, for people to read.
    """

    reason: str


def drive_on(corridor: Corridor, motion: Motion) -> Corridor:
    """Predict the place after the robot has moved."""
    mean_heading = corridor.heading_rad + motion.turn_rad / 2.0
    return replace(
        corridor,
        offset_m=corridor.offset_m + motion.way_m * math.sin(mean_heading),
        heading_rad=corridor.heading_rad + motion.turn_rad,
    )


def blend(expected: Corridor, seen: Corridor, share: float) -> Corridor:
    """Move the expected place by a share of the way to the one that was seen."""
    return Corridor(
        offset_m=expected.offset_m + share * (seen.offset_m - expected.offset_m),
        heading_rad=expected.heading_rad + share * (seen.heading_rad - expected.heading_rad),
        width_m=expected.width_m + share * (seen.width_m - expected.width_m),
    )
