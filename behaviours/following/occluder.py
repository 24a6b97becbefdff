"""A followed person who is hidden by another one: who that is, and where the person can be meanwhile."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from peopleboy.behaviours.following.target import Target, TargetConfig, bearing
from peopleboy.behaviours.percept import SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class OccluderConfig:
    """Who can hide whom.

    Attributes:
        behind_rad: [rad] farthest off the person that somebody who hides it can be.
        nearer: least ratio of that one's apparent height to the person's.
        half_width: [rad per image height] half the angle that somebody covers, by the apparent height.
    """

    behind_rad: float = math.radians(9.0)
    nearer: float = 0.9
    half_width: float = 0.12


def hider(
    people: Iterable[SeenPerson], target: Target, config: OccluderConfig, view: TargetConfig
) -> SeenPerson | None:
    """Find who is nearer than the followed person and about where it should be; None if nobody is."""
    in_front = [
        (abs(bearing(other.x, view) - target.bearing_rad), other)
        for other in people
        if other.is_sound
        and other.is_visible
        and other.id != target.id
        and other.height > config.nearer * target.height
    ]
    off_rad, other = min(in_front, key=lambda pair: pair[0], default=(math.inf, None))
    return other if off_rad < config.behind_rad else None


def keep_behind(
    target: Target, people: Iterable[SeenPerson], config: OccluderConfig, view: TargetConfig
) -> Target:
    """Take the person along with whoever hides it: whoever steps out from behind another one is seen."""
    other = hider(people, target, config, view)
    if other is None:
        return target
    middle, half = bearing(other.x, view), config.half_width * other.height
    return replace(target, bearing_rad=min(max(target.bearing_rad, middle - half), middle + half))
