"""A person keeps one number from the thermal image through the panorama and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from peopleboy.tracker.frame import THERMAL, Calibration, Frame
from peopleboy.tracker.handover.both_explanations import BothExplanations
from peopleboy.tracker.handover.departures import Departures
from peopleboy.tracker.handover.identities import Identities, Key
from peopleboy.tracker.handover.links import Votes, apartness, pairs
from peopleboy.tracker.panoramic.people.panoramic_tracker import PANORAMA, PanoramicTracker
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.thermal.whereabouts import standing_box
from peopleboy.tracker.track import Status, Track

NEEDED_VOTES: Final = 3
MOST_VOTES: Final = 15
FARTHEST_INTRODUCED_M: Final = 7.0
PAUSE_S: Final = 0.5  # between two introductions of one person
BORDER: Final = 0.02  # share of the image's width at either side in which nobody's middle is introduced


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

    def __init__(self, thermal: PeopleTracker, panoramic: PanoramicTracker) -> None:
        self._thermal, self._panoramic = thermal, panoramic
        self._votes = Votes(NEEDED_VOTES, MOST_VOTES)
        self._identities = Identities()
        self._departures = Departures()
        self._introduced_s: dict[int, float] = {}
        self._warm: tuple[int, ...] = ()

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
        numbers = self._identities.number
        number = {one: shared for (camera, one), shared in numbers.items() if camera == THERMAL}
        shown = {one: number[one] for one in self._warm if one in number}
        return BothExplanations.of(self._thermal.explanation, self._panoramic.explanation, shown)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is where.

        Raises:
            BadInput: as both trackers say.
        """
        around = self._panoramic.update(frame)
        warm = [track for track in self._thermal.update(frame) if track.status is not Status.TENTATIVE]
        self._departures.go_on(frame)
        self._warm = tuple(track.id for track in warm)
        agreed = pairs(
            [track for track in warm if _is_seen(track)], [track for track in around if _is_seen(track)]
        )
        by_heat, by_place = {track.id: track for track in warm}, {track.id: track for track in around}
        self._votes.count([(one.id, other.id) for one, other in agreed], by_heat, by_place)
        self._number(warm, around, agreed)
        self._introduce(around, warm, frame)
        joined = self._joined(warm, around)
        self._departures.note([track for track in joined if _is_seen(track)])
        return joined

    def _number(
        self, warm: Sequence[Track], around: Sequence[Track], agreed: Sequence[tuple[Track, Track]]
    ) -> None:
        numbers, linked = self._identities, self._votes.linked
        mates: dict[int, Key] = {one.id: (PANORAMA, other.id) for one, other in agreed}
        mates |= {one: (PANORAMA, other) for one, other in linked.items()}
        back: dict[int, Key] = {other: (THERMAL, one) for one, (_, other) in mates.items()}
        tracks = [*((PANORAMA, track) for track in around), *((THERMAL, track) for track in warm)]
        keys = [(camera, track.id) for camera, track in tracks]
        present = {numbers.number[key] for key in keys if key in numbers.number}
        guess = partial(self._departures.who, present=present)
        numbers.name(PANORAMA, around, back, guess)
        numbers.name(THERMAL, warm, mates, guess)
        by_heat, by_place = {track.id: track for track in warm}, {track.id: track for track in around}
        for one, other in linked.items():
            if one in by_heat and other in by_place:
                numbers.agree(((THERMAL, one), by_heat[one]), ((PANORAMA, other), by_place[other]), keys)

    def _introduce(self, around: Sequence[Track], warm: Sequence[Track], frame: Frame) -> None:
        """Point out to the thermal tracker whom it does not see, though that one is before its camera."""
        calibration = frame.calibrations.get(THERMAL)
        if calibration is None or THERMAL not in frame.images:
            return
        width = frame.images[THERMAL].shape[1]
        for track in around:
            if self._is_to_be_introduced(track, warm, calibration, width, frame.time_s):
                assert track.place is not None
                self._introduced_s[track.id] = frame.time_s
                self._thermal.introduce(standing_box(track.place, calibration))
                return

    def _is_to_be_introduced(
        self, track: Track, warm: Sequence[Track], calibration: Calibration, width: int, time_s: float
    ) -> bool:
        if not _is_seen(track) or track.place is None or track.id in self._votes.linked.values():
            return False
        if time_s - self._introduced_s.get(track.id, -PAUSE_S) < PAUSE_S:
            return False
        x, y = track.place.position_m
        if x <= 0.5 or (x * x + y * y) ** 0.5 > FARTHEST_INTRODUCED_M:
            return False
        left, _, wide, _ = standing_box(track.place, calibration)
        middle = left + wide / 2.0
        is_inside = BORDER * width <= middle <= (1.0 - BORDER) * width
        return is_inside and not any(_covers(other, middle) for other in warm)

    def _joined(self, warm: Sequence[Track], around: Sequence[Track]) -> tuple[Track, ...]:
        """Make one track of those that are one person."""
        number = self._identities.number
        joined = {
            number[PANORAMA, track.id]: replace(track, id=number[PANORAMA, track.id]) for track in around
        }
        hiders = {track.id: number[PANORAMA, track.id] for track in around}
        joined = {k: replace(t, occluder=hiders.get(t.occluder or 0)) for k, t in joined.items()}
        fronts = {track.id: number[THERMAL, track.id] for track in warm}
        for track in warm:
            one = fronts[track.id]
            own = replace(track, id=one, occluder=fronts.get(track.occluder or 0))
            joined[one] = _merged(own, joined[one]) if one in joined else own
        return tuple(joined[one] for one in sorted(joined))


def _merged(warm: Track, around: Track) -> Track:
    """Join two tracks of one person; its place is the panorama's as long as it is seen there."""
    better = around if _is_seen(around) or not _is_seen(warm) else warm
    is_near = apartness(warm, around) < 2 * 9.21 or not _is_seen(warm)
    return replace(
        better,
        boxes={**around.boxes, **(warm.boxes if is_near else {})},
        confidence=max(warm.confidence, around.confidence),
        status=warm.status if _is_seen(warm) else around.status,
        age_s=max(warm.age_s, around.age_s),
        occluder=warm.occluder if _is_seen(warm) else around.occluder,
    )


def _covers(track: Track, column: float) -> bool:
    left, _, width, _ = track.boxes[THERMAL]
    return left - 0.25 * width <= column <= left + 1.25 * width


def _is_seen(track: Track) -> bool:
    return track.status is not Status.TOTALLY_OCCLUDED
