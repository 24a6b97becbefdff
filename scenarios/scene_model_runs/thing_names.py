"""Which things of the truth a scene model tells of."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.scene_model_runs.true_events import NEAR_M, TrueEvent
from peopleboy.tracker.scene_model.scene import Happening


class _Match(NamedTuple):
    """One happening may tell of one event."""

    is_half: bool  # of a thing that was moved only one end is told
    way_m: float
    happening: int
    event: int
    ends: frozenset[str]


def thing_names(happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2) -> dict[int, str]:
    """Name objects, by their ids, after the things to which truly happened what is told of them.

    What was taken must have been where a thing was, and what was put down where a thing is. Each end of what
    truly happened is told once, by the happening that is nearest to it.

    Args:
        happenings: in the frame of the robot's first place.
        events: in the world.
        first: that place.
    """
    names: dict[int, str] = {}
    done: set[int] = set()
    taken: set[tuple[int, str]] = set()
    for match in sorted(_matches(happenings, events, first), key=lambda one: one[:4]):
        ends = {(match.event, end) for end in match.ends}
        if match.happening not in done and not ends & taken:
            done.add(match.happening)
            taken |= ends
            names.setdefault(happenings[match.happening].object, events[match.event].thing)
    return names


def _matches(happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2) -> Iterator[_Match]:
    for k, happening in enumerate(happenings):
        told = {"from": happening.from_m, "to": happening.to_m}
        for n, event in enumerate(events):
            true = {"from": event.from_m, "to": event.to_m}
            ways = {
                end: math.dist(place[:2], first.to_local(there))
                for end in told
                if (place := told[end]) is not None and (there := true[end]) is not None
            }
            is_whole = len(ways) == sum(place is not None for place in told.values())
            if event.is_about(happening.time_s) and is_whole and max(ways.values()) < NEAR_M:
                is_half = len(ways) < len(event.places_m)
                yield _Match(is_half, max(ways.values()), k, n, frozenset(ways))
