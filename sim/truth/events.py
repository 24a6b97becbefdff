"""What happens between one instant and the next: entries, exits, occlusions, contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from peopleboy.sim.truth.truth import PersonTruth, Truth

# Somebody enters the view when more than this share of the whole silhouette is seen, and leaves it when less
# than the second lies inside the image, hidden or not.
ENTERS_SEEN = 0.05
LEAVES_INSIDE = 0.02
# An occlusion starts when more than this share of what lies inside the image is hidden. Each ends at a lower
# share than it starts at, and a contact after some time apart: swinging arms and bounces are no news.
OCCLUSION_STARTS = 0.15
OCCLUSION_ENDS = 0.05
TOTAL_STARTS = 0.98
TOTAL_ENDS = 0.90
CONTACT_ENDS_S = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something worth a line in the log.

    Attributes:
        time_s: [s] since the start.
        kind: "enters view", "leaves view", "occlusion starts", "total occlusion starts",
            "total occlusion ends", "occlusion ends", "contact starts" or "contact ends".
        person: whom it happens to; the robot for contacts.
        other: who or what hides or touches them; empty if nobody.
    """

    time_s: float
    kind: str
    person: str
    other: str = ""


class EventLog:
    """Turns a sequence of truths into events, each told once, when it happens.

    A person that leaves the view takes its occlusions along: their ends are not told.
    """

    def __init__(self) -> None:
        self._in_view: set[str] = set()
        self._hidden_by: dict[str, str] = {}
        self._total: set[str] = set()
        self._last_touch_s: dict[str, float] = {}

    def update(self, truth: Truth) -> list[Event]:
        """Compare with the truth before, and return what is new."""
        found: list[tuple[str, str, str]] = []
        people = {person.name: person for person in truth.people}
        for name in sorted(self._in_view - people.keys()):
            found += self._leave(name)
        for person in truth.people:
            found += self._look_at(person)
        found += self._touch(truth.time_s, truth.contacts)
        return [Event(time_s=truth.time_s, kind=kind, person=who, other=other) for kind, who, other in found]

    def _look_at(self, person: PersonTruth) -> list[tuple[str, str, str]]:
        name = person.name
        if name in self._in_view:
            return self._leave(name) if person.inside_fraction < LEAVES_INSIDE else self._occlusion(person)
        if person.visible_fraction <= ENTERS_SEEN:
            return []
        self._in_view.add(name)
        return [("enters view", name, ""), *self._occlusion(person)]

    def _occlusion(self, person: PersonTruth) -> list[tuple[str, str, str]]:
        name, hidden, occluder = person.name, person.occluded_fraction, person.occluder or ""
        found = []
        if name not in self._hidden_by and hidden > OCCLUSION_STARTS:
            self._hidden_by[name] = occluder
            found.append(("occlusion starts", name, occluder))
        if name not in self._total and hidden > TOTAL_STARTS:
            self._total.add(name)
            found.append(("total occlusion starts", name, occluder))
        if name in self._total and hidden < TOTAL_ENDS:
            self._total.remove(name)
            found.append(("total occlusion ends", name, self._hidden_by[name]))
        if name in self._hidden_by and hidden < OCCLUSION_ENDS:
            found.append(("occlusion ends", name, self._hidden_by.pop(name)))
        return found

    def _leave(self, name: str) -> list[tuple[str, str, str]]:
        self._in_view.remove(name)
        self._hidden_by.pop(name, None)
        self._total.discard(name)
        return [("leaves view", name, "")]

    def _touch(self, time_s: float, contacts: Sequence[str]) -> list[tuple[str, str, str]]:
        last = self._last_touch_s
        found = [("contact starts", "robot", other) for other in contacts if other not in last]
        last.update(dict.fromkeys(contacts, time_s))
        for other in [name for name, touched_s in last.items() if time_s - touched_s >= CONTACT_ENDS_S]:
            del last[other]
            found.append(("contact ends", "robot", other))
        return found
