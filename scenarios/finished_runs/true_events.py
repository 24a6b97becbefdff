"""True changes of objects, and their assignment to the changes that a scene model reports."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.sim.truth.events import ThingEvent
from peopleboy.tracker.scene_model.scene import Happening

KINDS: Final = ("thing moved", "thing appeared", "thing vanished")
"""Kinds of lines in a run's event log that are about objects."""

EARLY_S: Final = 2.0
LATE_S: Final = 3.0
"""[s] maximum time between a reported and a true change."""

NEAR_M: Final = 0.75
"""[m] maximum floor distance between the centre of the visible part of an object and its true centre."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrueEvent:
    """A change of an object.

    Attributes:
        thing: name of the object.
        by: name of the person who caused it; empty for none.
        from_s, to_s: [s] start and end of the change.
        from_m: (x, y) [m] earlier position in the world; None if the object was not there.
        to_m: (x, y) [m] later position; None if the object is no longer there.
    """

    thing: str
    by: str
    from_s: float
    to_s: float
    from_m: tuple[float, float] | None = None
    to_m: tuple[float, float] | None = None

    @classmethod
    def of(cls, line: ThingEvent | LogLine, thing: str, by: str, place_m: tuple[float, float]) -> "TrueEvent":
        """Make an event from a line of the log; `place_m` is the object's position if it was not moved."""
        if line.move is not None:
            ends = {"from_m": line.move.from_m[:2], "to_m": line.move.to_m[:2]}
            return cls(thing=thing, by=by, from_s=line.move.from_s, to_s=line.move.to_s, **ends)
        end = {"from_m" if line.kind == "thing vanished" else "to_m": place_m}
        return cls(thing=thing, by=by, from_s=line.time_s, to_s=line.time_s, **end)

    @property
    def places_m(self) -> tuple[tuple[float, float], ...]:
        """Earlier and later position of the object: one or two positions."""
        return tuple(place for place in (self.from_m, self.to_m) if place is not None)

    def is_about(self, time_s: float) -> bool:
        """Return whether a reported time fits this event."""
        return self.from_s - EARLY_S <= time_s <= self.to_s + LATE_S


def matching(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2
) -> Mapping[int, tuple[int, ...]]:
    """Return the events that each reported change may correspond to; changes without any are left out.

    Args:
        happenings: reported changes, in the frame of the robot's start pose.
        events: true events, in the world.
        first: the robot's start pose.
    """
    found = {}
    for k, happening in enumerate(happenings):
        ways = {n: _apart_m(happening, event, first) for n, event in enumerate(events)}
        likely = [n for n in sorted(ways, key=lambda n: ways[n]) if ways[n] < NEAR_M]
        if likely:
            found[k] = tuple(likely)
    return found


def _apart_m(happening: Happening, event: TrueEvent, first: Pose2) -> float:
    """Return the distance between the nearest ends; infinity if the times do not fit."""
    if not event.is_about(happening.time_s):
        return math.inf
    ends = [end[:2] for end in (happening.from_m, happening.to_m) if end is not None]
    return min(math.dist(end, first.to_local(place)) for end in ends for place in event.places_m)


class PersonNames:
    """Find the names of people that a scene model tracks, from their positions."""

    def __init__(self) -> None:
        self._votes: dict[int, dict[str, int]] = {}

    def look(
        self, seen: Iterable[tuple[int, tuple[float, float]]], true: Iterable[tuple[str, tuple[float, float]]]
    ) -> None:
        """Compare positions by id with true positions by name, at one instant and in one frame."""
        people = list(true)
        for number, place in seen:
            name, way = min(
                ((name, math.dist(place, other)) for name, other in people),
                key=lambda one: one[1],
                default=("", math.inf),
            )
            if way < NEAR_M:
                votes = self._votes.setdefault(number, {})
                votes[name] = votes.get(name, 0) + 1

    def name(self, number: int | None) -> str | None:
        """Return the name of a person; None for no person, and for an id that was never near a person."""
        votes = self._votes.get(number, {}) if number is not None else {}
        return max(votes, key=lambda name: votes[name]) if votes else None


# Assign reported changes to objects.


class _Match(NamedTuple):
    """A reported change that may correspond to a true event."""

    is_half: bool  # only one end of a move is reported
    way_m: float
    happening: int
    event: int
    ends: frozenset[str]


def thing_names(happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2) -> dict[int, str]:
    """Name objects, by their ids, after the objects whose true events match the reported changes.

    A reported removal must start where an object was, and a reported placement must end where an object is.
    Each end of a true event is assigned once, to the nearest reported change.

    Args:
        happenings: reported changes, in the frame of the robot's start pose.
        events: true events, in the world.
        first: the robot's start pose.
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
        ends = {"from": happening.from_m, "to": happening.to_m}
        for n, event in enumerate(events):
            true = {"from": event.from_m, "to": event.to_m}
            ways = {
                end: math.dist(place[:2], first.to_local(there))
                for end in ends
                if (place := ends[end]) is not None and (there := true[end]) is not None
            }
            is_whole = len(ways) == sum(place is not None for place in ends.values())
            if event.is_about(happening.time_s) and is_whole and max(ways.values()) < NEAR_M:
                is_half = len(ways) < len(event.places_m)
                yield _Match(is_half, max(ways.values()), k, n, frozenset(ways))
