"""Eyes that are told the truth, in a tracker's place: following without errors of seeing."""

from __future__ import annotations

from collections.abc import Callable

from peopleboy.sim.truth.seen import is_seen
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Status, Track

TRUTH = "truth"


class OracleTracker:
    """Gives everybody's true box under the person's own number, as long as enough of it is to be seen.

    Who is hidden in the image goes on as a totally occluded track; who is out of the image has none.
    """

    def __init__(self, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        self._first_s: dict[int, float] = {}

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Look at the truth instead of the frame."""
        return tuple(
            self._track(person, frame.time_s)
            for person in self._truth().people
            if person.box is not None and is_seen(person.inside_fraction)
        )

    def _track(self, person: PersonTruth, time_s: float) -> Track:
        assert person.box is not None
        return Track(
            id=person.id,
            box=person.box,
            confidence=1.0,
            status=Status.TRACKED if is_seen(person.visible_fraction) else Status.TOTALLY_OCCLUDED,
            age_s=time_s - self._first_s.setdefault(person.id, time_s),
        )
