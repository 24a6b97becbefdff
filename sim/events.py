"""What happens between one instant and the next: entries, exits, occlusions, contacts."""

from __future__ import annotations

from dataclasses import dataclass

from sim.truth import PersonTruth, Truth

# An occlusion starts when more than the first share of what is inside the image is hidden, and ends when less
# than the second is; a total one has less than the third left to see.
OCCLUSION_STARTS = 0.15
OCCLUSION_ENDS = 0.05
TOTAL_LEAVES = 0.02


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
    """Turns a sequence of truths into events, each told once, when it happens."""

    def __init__(self) -> None:
        self._in_view: set[str] = set()
        self._hidden_by: dict[str, str] = {}
        self._total: set[str] = set()
        self._touched: set[str] = set()

    def update(self, truth: Truth) -> list[Event]:
        """Compare with the truth before, and return what is new."""
        found: list[tuple[str, str, str]] = []
        people = {person.name: person for person in truth.people}
        for name in sorted(self._in_view - people.keys()):
            found += self._leave(name)
        for person in truth.people:
            found += self._look_at(person)
        found += self._touch(set(truth.contacts))
        return [Event(time_s=truth.time_s, kind=kind, person=who, other=other) for kind, who, other in found]

    def _look_at(self, person: PersonTruth) -> list[tuple[str, str, str]]:
        name = person.name
        if not person.is_in_image:
            return self._leave(name) if name in self._in_view else []
        found = []
        if name not in self._in_view:
            self._in_view.add(name)
            found.append(("enters view", name, ""))
        return found + self._occlusion(person)

    def _occlusion(self, person: PersonTruth) -> list[tuple[str, str, str]]:
        name, hidden, occluder = person.name, person.occluded_fraction, person.occluder or ""
        found = []
        if name not in self._hidden_by and hidden > OCCLUSION_STARTS:
            self._hidden_by[name] = occluder
            found.append(("occlusion starts", name, occluder))
        if name not in self._total and hidden > 1.0 - TOTAL_LEAVES:
            self._total.add(name)
            found.append(("total occlusion starts", name, occluder))
        if name in self._total and hidden < 1.0 - 2.0 * TOTAL_LEAVES:
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

    def _touch(self, touched: set[str]) -> list[tuple[str, str, str]]:
        found = [("contact starts", "robot", other) for other in sorted(touched - self._touched)]
        found += [("contact ends", "robot", other) for other in sorted(self._touched - touched)]
        self._touched = touched
        return found
