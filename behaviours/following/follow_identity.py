"""Who among the people in the image is the one that the robot follows."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.behaviours.following.target import Target, TargetConfig, bearing
from peopleboy.behaviours.percept import SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowIdentityConfig:
    """When a track under a new number is taken for the followed person.

    Attributes:
        min_confidence: people of lower confidence are not followed.
        off_rad: [rad] farthest from where the person should be ...
        off_rad_s: [rad/s] ... and how fast that grows while the person is out of sight.
        size: largest ratio of the apparent heights, as its logarithm ...
        size_1_s: [1/s] ... and how fast that grows.
        place_s: [s] out of sight for longer than this, a person may come back anywhere.
    """

    min_confidence: float = 0.5
    off_rad: float = math.radians(6.0)
    off_rad_s: float = math.radians(7.0)
    size: float = 0.3
    size_1_s: float = 0.15
    place_s: float = 4.0


def recognise(
    people: tuple[SeenPerson, ...],
    target: Target | None,
    others: frozenset[int],
    gap_s: float,
    config: FollowIdentityConfig,
    view: TargetConfig,
    *,
    knows_again: bool = False,
) -> SeenPerson | None:
    """Find the followed person among those in the image; None if it is not seen.

    With no target it is whoever seems nearest (tallest). A person who is tracked, though hidden just now,
    is not exchanged for another; and nobody who was seen beside the person is ever taken for it.

    Args:
        people: the tracker's people.
        target: the followed person, its bearing being predicted for this image; None to choose one.
        others: tracks that were seen beside the target.
        gap_s: [s] since the target was seen.
        config: how far off a track under another number may be.
        view: bearings of image columns.
        knows_again: whether the person has its old number when it comes back.
    """
    seen = [p for p in people if p.is_sound and p.is_visible and p.confidence >= config.min_confidence]
    if target is None:
        return max(seen, key=lambda person: person.height, default=None)
    if knows_again or any(person.id == target.id for person in people):
        return next((person for person in seen if person.id == target.id), None)
    fitting = [
        person
        for person in seen
        if person.id not in others and (gap_s > config.place_s or _fits(person, target, gap_s, config, view))
    ]
    return min(fitting, key=lambda person: _off(person, target, view), default=None)


def company(people: tuple[SeenPerson, ...], target: int, others: frozenset[int]) -> frozenset[int]:
    """Add everybody else who is seen to those who are another person than the followed person.

    That is true beside the person, and also soon after it was lost, of those who are where it cannot be.
    """
    return (others | {person.id for person in people if person.is_visible}) - {target}


def _fits(
    person: SeenPerson, target: Target, gap_s: float, config: FollowIdentityConfig, view: TargetConfig
) -> bool:
    """Return whether a person is where the target should be by now, and about as tall."""
    size = abs(math.log(person.height / target.height))
    return (
        _off(person, target, view) < config.off_rad + config.off_rad_s * gap_s
        and size < config.size + config.size_1_s * gap_s
    )


def _off(person: SeenPerson, target: Target, view: TargetConfig) -> float:
    return abs(math.remainder(bearing(person.x, view) - target.bearing_rad, math.tau))
