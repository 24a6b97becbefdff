"""What truly happened to things, and which of it a scene model reported."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.sim.truth.events import ThingEvent
from peopleboy.tracker.scene_model.scene import Happening

KINDS: Final = ("thing moved", "thing appeared", "thing vanished")
"""Kinds of lines in the log of a run that tell of things."""

EARLY_S: Final = 2.0
LATE_S: Final = 3.0
"""[s] by which a happening may be reported before or after what truly happened."""

NEAR_M: Final = 0.75
"""[m] on the floor between the middle of what was seen of a thing, and the middle of the thing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrueEvent:
    """Something that happened to a thing.

    Attributes:
        thing: its name.
        by: name of who did it; empty for nobody.
        from_s, to_s: when it began and ended [s].
        from_m: (x, y) where the thing was, in the world [m]; None if it was not there.
        to_m: (x, y) where it is; None if it is there no more.
    """

    thing: str
    by: str
    from_s: float
    to_s: float
    from_m: tuple[float, float] | None = None
    to_m: tuple[float, float] | None = None

    @classmethod
    def of(cls, line: ThingEvent | LogLine, thing: str, by: str, place_m: tuple[float, float]) -> "TrueEvent":
        """Read it from a line of the log; `place_m` is where the thing is if it was not moved."""
        if line.move is not None:
            ends = {"from_m": line.move.from_m[:2], "to_m": line.move.to_m[:2]}
            return cls(thing=thing, by=by, from_s=line.move.from_s, to_s=line.move.to_s, **ends)
        end = {"from_m" if line.kind == "thing vanished" else "to_m": place_m}
        return cls(thing=thing, by=by, from_s=line.time_s, to_s=line.time_s, **end)

    @property
    def places_m(self) -> tuple[tuple[float, float], ...]:
        """Where the thing was, and is: one or two places."""
        return tuple(place for place in (self.from_m, self.to_m) if place is not None)

    def is_about(self, time_s: float) -> bool:
        """Whether a reported time may be this."""
        return self.from_s - EARLY_S <= time_s <= self.to_s + LATE_S


def matching(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2
) -> Mapping[int, tuple[int, ...]]:
    """Return which events each happening may tell of, by their numbers; those that tell of none are left out.

    Args:
        happenings: in the frame of the robot's first place.
        events: in the world.
        first: that place.
    """
    found = {}
    for k, happening in enumerate(happenings):
        ways = {n: _apart_m(happening, event, first) for n, event in enumerate(events)}
        likely = [n for n in sorted(ways, key=lambda n: ways[n]) if ways[n] < NEAR_M]
        if likely:
            found[k] = tuple(likely)
    return found


def _apart_m(happening: Happening, event: TrueEvent, first: Pose2) -> float:
    """Return the distance of the nearest ends; infinity if it was at another time."""
    if not event.is_about(happening.time_s):
        return math.inf
    ends = [end[:2] for end in (happening.from_m, happening.to_m) if end is not None]
    return min(math.dist(end, first.to_local(place)) for end in ends for place in event.places_m)


class PersonNames:
    """Finds the names of people that a scene model follows, by where they are."""

    def __init__(self) -> None:
        self._votes: dict[int, dict[str, int]] = {}

    def look(
        self, seen: Iterable[tuple[int, tuple[float, float]]], true: Iterable[tuple[str, tuple[float, float]]]
    ) -> None:
        """Compare ids with places and names with places, at one instant and in one frame."""
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
        """Return the name of a person; None for nobody, and for who was never near anybody."""
        votes = self._votes.get(number, {}) if number is not None else {}
        return max(votes, key=lambda name: votes[name]) if votes else None


# Which true things the changes of a scene model are about.


class _Match(NamedTuple):
    """One happening may tell of one event."""

    is_half: bool  # of a thing that was moved only one end is reported
    way_m: float
    happening: int
    event: int
    ends: frozenset[str]


def thing_names(happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Pose2) -> dict[int, str]:
    """Name objects, by their ids, after the things to which truly happened what the model reports.

    What was taken must have been where a thing was, and what was put down where a thing is. Each end of what
    truly happened is reported once, by the happening that is nearest to it.

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
