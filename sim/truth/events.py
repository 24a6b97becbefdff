"""Events between one instant and the next: entries, exits, falls, occlusions and contacts."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.shapes.shapes import Vector
from peopleboy.sim.truth.truth import BORDER, PersonTruth, ThingTruth, Truth

_Reported = tuple[str, str, str]  # kind, person, other

# A person enters the view when more than the first share of the whole silhouette is visible, and leaves it
# when less than the second lies inside the image, hidden or not.
ENTERS_SEEN = 0.05
LEAVES_INSIDE = 0.02
# An occlusion starts when one occluder hides more than the first share of the silhouette inside the image, a
# total one when all together hide more than the third. Each ends at a lower share than it starts at, and a
# contact after some time apart, so that swinging arms and bounces cause no repeated events.
OCCLUSION_STARTS = 0.15
OCCLUSION_ENDS = 0.05
TOTAL_STARTS = 0.98
TOTAL_ENDS = 0.90
CONTACT_ENDS_S = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """An event for the log.

    Attributes:
        time_s: [s] since the start.
        kind: "enters view", "leaves view", "falls", "occlusion starts", "total occlusion starts",
            "total occlusion ends", "occlusion ends", "contact starts" or "contact ends".
        person: the person concerned; the robot for contacts.
        other: the person or thing that hides or touches them; for a total occlusion the one that hides most
            when it starts, repeated when it ends; empty for none.
    """

    time_s: float
    kind: str
    person: str
    other: str = ""


class EventLog:
    """Convert a sequence of ground truths to events, each reported once, when it happens.

    Each occluder has a separate occlusion. It ends when the hidden person leaves the view or
    the image. A person who has not entered the view yet can only be occluded by people: a person who waits
    behind a wall causes no event.
    """

    def __init__(self) -> None:
        self._in_view: set[str] = set()
        self._upright: set[str] = set()
        self._hidden: dict[str, list[str]] = {}
        self._total: dict[str, str] = {}
        self._last_touch_s: dict[str, float] = {}

    def update(self, truth: Truth) -> list[Event]:
        """Compare with the previous truth, and return new events."""
        found: list[_Reported] = []
        people = {person.name: person for person in truth.people}
        for name in sorted((self._in_view | self._hidden.keys() | self._total.keys()) - people.keys()):
            found += self._leave(name)
        for person in truth.people:
            found += self._fall(person) + self._look_at(person, people.keys())
        found += self._touch(truth.time_s, truth.contacts)
        return [Event(time_s=truth.time_s, kind=kind, person=who, other=other) for kind, who, other in found]

    def _fall(self, person: PersonTruth) -> list[_Reported]:
        """Report the start of a fall, in view or not; lying there from the start is no fall."""
        name, was_upright = person.name, person.name in self._upright
        if person.posture != Posture.FALLEN:
            self._upright.add(name)
            return []
        self._upright.discard(name)
        return [("falls", name, "")] if was_upright else []

    def _look_at(self, person: PersonTruth, people: Collection[str]) -> list[_Reported]:
        name, found = person.name, list[_Reported]()
        if person.inside_fraction < LEAVES_INSIDE:
            return self._leave(name)
        if name not in self._in_view and person.visible_fraction > ENTERS_SEEN:
            self._in_view.add(name)
            found.append(("enters view", name, ""))
        shares = {
            other: person.hidden_inside(other)
            for other in person.hidden_by
            if other != BORDER and (name in self._in_view or other in people)
        }
        return found + self._occlusions(name, shares)

    def _occlusions(self, name: str, shares: Mapping[str, float]) -> list[_Reported]:
        """Return new occlusion events, given the share that each occluder hides."""
        found: list[_Reported] = []
        hidden, total = self._hidden.setdefault(name, []), sum(shares.values())
        most = max(shares, key=lambda other: shares[other], default="")
        starts = [
            other for other, share in shares.items() if share > OCCLUSION_STARTS and other not in hidden
        ]
        hidden += starts
        found += [("occlusion starts", name, other) for other in starts]
        if name not in self._total and total > TOTAL_STARTS:
            self._total[name] = most
            found.append(("total occlusion starts", name, most))
        elif name in self._total and total < TOTAL_ENDS:
            found.append(("total occlusion ends", name, self._total.pop(name)))
        ends = [other for other in hidden if shares.get(other, 0.0) < OCCLUSION_ENDS]
        self._hidden[name] = [other for other in hidden if other not in ends]
        return found + [("occlusion ends", name, other) for other in ends]

    def _leave(self, name: str) -> list[_Reported]:
        found = self._occlusions(name, {})
        if name in self._in_view:
            self._in_view.remove(name)
            found.append(("leaves view", name, ""))
        del self._hidden[name]
        return found

    def _touch(self, time_s: float, contacts: Sequence[str]) -> list[_Reported]:
        last = self._last_touch_s
        found = [("contact starts", "robot", other) for other in contacts if other not in last]
        last.update(dict.fromkeys(contacts, time_s))
        for other in [name for name, touched_s in last.items() if time_s - touched_s >= CONTACT_ENDS_S]:
            del last[other]
            found.append(("contact ends", "robot", other))
        return found


# Events of things: moves, with their start, end and mover, appearances and disappearances.

STANDS_S = 0.5  # a move is over when the thing has stood this long; sooner motions belong to it
_SOON_S = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """Movement of a thing from one rest position to the next.

    Attributes:
        from_s, to_s: [s] start and end of the move.
        from_m, to_m: (x, y, z) [m] position of its frame at start and end, world frame.
        distance_m: [m] straight distance between the two.
        turned_deg: [deg] angle by which it was turned, at most 180; positive to the left.
    """

    from_s: float
    to_s: float
    from_m: Vector
    to_m: Vector
    distance_m: float
    turned_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingEvent:
    """An event for the log.

    Attributes:
        time_s: [s] since the start.
        kind: "thing moved", "thing appeared" or "thing vanished".
        thing: name of the thing.
        by: the person who moved it; empty for none.
        move: the move, for "thing moved"; None otherwise.
    """

    time_s: float
    kind: str
    thing: str
    by: str = ""
    move: Move | None = None


class ThingLog:
    """Convert a sequence of ground truths to events. A move is reported when the thing comes to rest."""

    def __init__(self) -> None:
        self._watched: dict[str, _EventWatch] = {}

    def update(self, truth: Truth) -> list[ThingEvent]:
        """Compare with the previous truths, and return new events."""
        found = []
        for thing in truth.things:
            watch = self._watched.setdefault(thing.name, _EventWatch(thing, truth.time_s))
            event = watch.look(thing, truth.time_s)
            found += [event] if event is not None else []
        return found


class _EventWatch:
    """Keeps the last rest pose of one thing."""

    def __init__(self, thing: ThingTruth, time_s: float) -> None:
        self._rest = thing
        self._was_there = thing.is_there
        self._moved: ThingTruth | None = None
        self._off_s = self._still_s = time_s

    def look(self, thing: ThingTruth, time_s: float) -> ThingEvent | None:
        if thing.is_there != self._was_there:
            self._was_there = thing.is_there
            self._settle(thing)
            kind = "thing appeared" if thing.is_there else "thing vanished"
            return ThingEvent(time_s=time_s, kind=kind, thing=thing.name, by=thing.moved_by or "")
        if thing.is_moving:
            self._off_s = time_s if self._moved is None else self._off_s
            self._moved, self._still_s = thing, time_s
        elif self._moved is None:
            self._settle(thing)
        else:
            return self._maybe_moved(thing, time_s)
        return None

    def _maybe_moved(self, thing: ThingTruth, time_s: float) -> ThingEvent | None:
        if self._moved is not None and self._moved.is_moving:
            self._moved, self._still_s = thing, time_s
        if time_s < self._still_s + STANDS_S - _SOON_S:
            return None
        move = _move(self._rest, self._off_s, thing, self._still_s)
        self._settle(thing)
        by = thing.moved_by or ""
        return ThingEvent(time_s=time_s, kind="thing moved", thing=thing.name, by=by, move=move)

    def _settle(self, thing: ThingTruth) -> None:
        self._rest, self._moved = thing, None


def _move(before: ThingTruth, from_s: float, after: ThingTruth, to_s: float) -> Move:
    turn = math.remainder(after.heading_rad - before.heading_rad, math.tau)
    return Move(
        from_s=from_s,
        to_s=to_s,
        from_m=_rounded(before.position_m),
        to_m=_rounded(after.position_m),
        distance_m=round(math.dist(before.position_m, after.position_m), 4),
        turned_deg=round(math.degrees(turn), 2),
    )


def _rounded(place: Vector) -> Vector:
    x, y, z = (round(coordinate, 4) for coordinate in place)
    return x, y, z
