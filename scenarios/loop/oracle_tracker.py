"""Eyes that are told the truth, in a tracker's place: following without errors of seeing."""

from __future__ import annotations

from collections.abc import Callable

from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.truth.scenes import is_seen
from peopleboy.sim.truth.truth import PersonTruth, Truth
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import FloorPlace, Status, Track


class OracleTracker:
    """Gives everybody's true box under the person's own number, as long as enough of it is to be seen.

    Who is hidden in the image goes on as a totally occluded track; who is out of the image has none.
    """

    def __init__(self, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        self._first_s: dict[int, float] = {}

    @property
    def cameras(self) -> tuple[str, ...]:
        """None: it looks at no image."""
        return ()

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Look at the truth instead of the frame."""
        truth = self._truth()
        return tuple(
            self._track(person, truth.robot, frame.time_s)
            for person in truth.people
            if person.box is not None and is_seen(person.inside_fraction)
        )

    def _track(self, person: PersonTruth, robot: Planar, time_s: float) -> Track:
        assert person.box is not None
        return Track(
            id=person.id,
            boxes={THERMAL: person.box},
            place=_place(person, robot),
            confidence=1.0,
            status=Status.TRACKED if is_seen(person.visible_fraction) else Status.TOTALLY_OCCLUDED,
            age_s=time_s - self._first_s.setdefault(person.id, time_s),
        )


def _place(person: PersonTruth, robot: Planar) -> FloorPlace:
    return FloorPlace(position_m=robot.locate(person.position_m), covariance_m2=(0.0, 0.0, 0.0))
