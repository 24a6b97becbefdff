"""What truly happened to things, and which of it a scene model told."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.truth.thing_events import Move
from peopleboy.tracker.scene_model.scene import Happening

KINDS: Final = ("thing moved", "thing appeared", "thing vanished")
"""Kinds of lines in the log of a run that tell of things."""

EARLY_S: Final = 2.0
LATE_S: Final = 3.0
"""[s] by which a happening may be told to be before or after what truly happened."""

NEAR_M: Final = 0.75
"""[m] on the floor between the middle of what was seen of a thing, and the middle of the thing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrueEvent:
    """Something that happened to a thing.

    Attributes:
        thing: its name.
        by: name of who did it; empty for nobody.
        from_s, to_s: when it began and ended [s].
        places_m: (x, y) where the thing was, and is, in the world [m].
    """

    thing: str
    by: str
    from_s: float
    to_s: float
    places_m: tuple[tuple[float, float], ...]

    @classmethod
    def of(
        cls, thing: str, by: str, time_s: float, move: Move | None, place_m: tuple[float, float]
    ) -> TrueEvent:
        """Read it from a line of the log; `place_m` is where the thing is if it was not moved."""
        if move is None:
            return cls(thing=thing, by=by, from_s=time_s, to_s=time_s, places_m=(place_m,))
        places = move.from_m[:2], move.to_m[:2]
        return cls(thing=thing, by=by, from_s=move.from_s, to_s=move.to_s, places_m=places)


def matching(
    happenings: Sequence[Happening], events: Sequence[TrueEvent], first: Planar
) -> Mapping[int, tuple[int, ...]]:
    """Tell which events each happening may tell of, by their numbers; those that tell of none are left out.

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


def _apart_m(happening: Happening, event: TrueEvent, first: Planar) -> float:
    """Give the distance of the nearest ends; infinity if it was at another time."""
    if not event.from_s - EARLY_S <= happening.time_s <= event.to_s + LATE_S:
        return math.inf
    ends = [end[:2] for end in (happening.from_m, happening.to_m) if end is not None]
    return min(math.dist(end, first.locate(place)) for end in ends for place in event.places_m)


class WhoIsWho:
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
        """Give the name of a person; None for nobody, and for who was never near anybody."""
        votes = self._votes.get(number, {}) if number is not None else {}
        return max(votes, key=lambda name: votes[name]) if votes else None
