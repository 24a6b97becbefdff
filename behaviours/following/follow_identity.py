"""Identification of the followed person among the people in the image."""

import math
from dataclasses import dataclass

from peopleboy.behaviours.following.target import Target, TargetConfig, bearing
from peopleboy.behaviours.percept import SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowIdentityConfig:
    """When a track with a new id is taken for the followed person.

    Attributes:
        min_confidence: people of lower confidence are not followed.
        off_rad: [rad] greatest distance from the predicted bearing ...
        off_rad_s: [rad/s] ... and its growth while the person is not visible.
        size: greatest ratio of the apparent heights, as its logarithm ...
        size_1_s: [1/s] ... and its growth.
        place_s: [s] time without observation after which a person may return anywhere.
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
    """Return the followed person among those in the image; None if not visible.

    Without a target, the tallest person is chosen. A tracked person is not exchanged for another one, even
    during occlusion. People who were visible together with the target are never chosen.

    Args:
        people: the tracker's people.
        target: the followed person with the bearing predicted for this image; None to choose one.
        others: tracks that were visible together with the target.
        gap_s: [s] time since the target was last visible.
        config: tolerances for a track with another id.
        view: bearings of image columns.
        knows_again: whether a returning person gets the previous id.
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
    """Add other visible people to the tracks that are not the followed person.

    People count while the followed person is visible, and shortly after a loss if they are at positions that
    the person cannot have reached.
    """
    return (others | {person.id for person in people if person.is_visible}) - {target}


def _fits(
    person: SeenPerson, target: Target, gap_s: float, config: FollowIdentityConfig, view: TargetConfig
) -> bool:
    """Return whether a person is at the target's predicted bearing, and of similar height."""
    size = abs(math.log(person.height / target.height))
    return (
        _off(person, target, view) < config.off_rad + config.off_rad_s * gap_s
        and size < config.size + config.size_1_s * gap_s
    )


def _off(person: SeenPerson, target: Target, view: TargetConfig) -> float:
    return abs(math.remainder(bearing(person.x, view) - target.bearing_rad, math.tau))
