"""A person keeps one number from the thermal image through the panorama and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final, Protocol

from peopleboy.tracker.frame import PANORAMA, THERMAL, Calibration, Frame
from peopleboy.tracker.handover.both_explanations import BothExplanations
from peopleboy.tracker.handover.departures import Departures
from peopleboy.tracker.handover.identities import Identities
from peopleboy.tracker.handover.introductions import Introductions
from peopleboy.tracker.handover.joining import joined, renamed
from peopleboy.tracker.handover.links import Votes, is_seen, pairs
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.thermal.explanation import ContourExplanation
from peopleboy.tracker.track import Box, Status, Track

NEEDED_VOTES: Final = 3
MOST_VOTES: Final = 15


class Ahead(Protocol):
    """A tracker of people in the thermal image, by that alone or by more."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras whose images it wants."""
        ...

    @property
    def explanation(self) -> ContourExplanation:
        """Contours and samples behind its tracks."""
        ...

    def introduce(self, box: Box) -> None:
        """Tell that a person is at this box [px] of the thermal image in the next frame."""
        ...

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen."""
        ...


class HandoverTracker:
    """Two trackers that know each other's people: one for what is warm ahead, one for all round the robot.

    Tracks that stand at the same place for several frames are one person. Whoever comes into the thermal
    image is pointed out to its tracker by the other one, so that its number is there from the first frame on.

    Args:
        thermal: tracks people in the thermal image.
        panoramic: tracks them in the panorama.

    Source: thesis, section 8.2, which proposes it: people are learned in the thermal image, and tracked by
    that in the omnidirectional one.
    """

    def __init__(self, thermal: Ahead, panoramic: PanoramicTracker) -> None:
        self._thermal, self._panoramic = thermal, panoramic
        self._votes = Votes(NEEDED_VOTES, MOST_VOTES)
        self._identities = Identities()
        self._departures = Departures()
        self._introductions = Introductions()
        self._warm: tuple[Track, ...] = ()

    @property
    def cameras(self) -> tuple[str, ...]:
        """Those of both trackers."""
        return (*self._thermal.cameras, *self._panoramic.cameras)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a panoramic camera that its tracker was not trained on, before there are images.

        Raises:
            BadInput: it is another, or none that sees all round.
        """
        self._panoramic.check_cameras(calibrations)

    @property
    def explanation(self) -> BothExplanations:
        """Those of both trackers."""
        shown = {track.id: number for number, track in self._identities.of(THERMAL, self._warm).items()}
        return BothExplanations.of(self._thermal.explanation, self._panoramic.explanation, shown)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is where.

        Raises:
            BadInput: as both trackers say.
        """
        around = self._panoramic.update(frame)
        warm = [track for track in self._thermal.update(frame) if track.status is not Status.TENTATIVE]
        self._warm = tuple(warm)
        self._departures.go_on(frame)
        self._number(warm, around)
        self._introduce(around, warm, frame)
        by_heat, by_place = self._identities.of(THERMAL, warm), self._identities.of(PANORAMA, around)
        self._departures.note(THERMAL, by_heat)
        self._departures.note(PANORAMA, by_place)
        return joined(renamed(by_heat), renamed(by_place), frame)

    def _number(self, warm: Sequence[Track], around: Sequence[Track]) -> None:
        """Give all tracks their numbers, and one to two that have been together for long enough."""
        by_heat, by_place = {track.id: track for track in warm}, {track.id: track for track in around}
        seen = pairs([one for one in warm if is_seen(one)], [one for one in around if is_seen(one)])
        agreed = {one.id: other.id for one, other in seen}
        self._votes.count(list(agreed.items()), by_heat, by_place)
        linked, numbers = self._votes.linked, self._identities
        mates = agreed | linked
        self._name(PANORAMA, around, {other: one for one, other in mates.items()}, THERMAL, warm)
        self._name(THERMAL, warm, mates, PANORAMA, around)
        keys = [*((PANORAMA, one) for one in by_place), *((THERMAL, one) for one in by_heat)]
        for one, other in linked.items():
            if one in by_heat and other in by_place:
                numbers.agree(((THERMAL, one), by_heat[one]), ((PANORAMA, other), by_place[other]), keys)

    def _name(
        self,
        camera: str,
        tracks: Sequence[Track],
        mates: Mapping[int, int],
        other: str,
        others: Sequence[Track],
    ) -> None:
        """Number the new tracks of a camera by their mates of the other one, or by who was near last."""
        known = {one: (other, mate) for one, mate in mates.items()}
        guess = partial(self._departures.who, camera=camera, others=self._identities.of(other, others))
        self._identities.name(camera, tracks, known, guess)

    def _introduce(self, around: Sequence[Track], warm: Sequence[Track], frame: Frame) -> None:
        """Point out to the thermal tracker whom it does not see, though that one is before its camera."""
        present = {track.id for track in warm}
        linked = {other for one, other in self._votes.linked.items() if one in present}
        box = self._introductions.next(around, warm, linked, frame)
        if box is not None:
            self._thermal.introduce(box)
