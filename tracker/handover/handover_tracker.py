"""A person keeps one number from the thermal image through the panorama and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final, Protocol

from peopleboy.tracker.frame import PANORAMA, THERMAL, Calibration, Frame
from peopleboy.tracker.handover.both_explanations import BothExplanations
from peopleboy.tracker.handover.departures import Departures
from peopleboy.tracker.handover.identities import Identities, Key
from peopleboy.tracker.handover.introductions import Introductions, thermal_view
from peopleboy.tracker.handover.links import GATE, Votes, apartness, pairs
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.thermal.explanation import ContourExplanation
from peopleboy.tracker.track import Box, Status, Track

NEEDED_VOTES: Final = 3
MOST_VOTES: Final = 15
DOUBTFUL_S: Final = 0.7
DOUBTFUL_RAD: Final = math.radians(6.0)


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
        joined = self._joined(warm, around, frame)
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
        seen = [(camera, track.id) for camera, track in tracks if _is_seen(track)]
        present = {numbers.number[key] for key in seen if key in numbers.number}
        guess = partial(self._departures.who, present=present)
        numbers.name(PANORAMA, around, back, guess)
        numbers.name(THERMAL, warm, mates, guess)
        by_heat, by_place = {track.id: track for track in warm}, {track.id: track for track in around}
        for one, other in linked.items():
            if one in by_heat and other in by_place:
                numbers.agree(((THERMAL, one), by_heat[one]), ((PANORAMA, other), by_place[other]), keys)

    def _introduce(self, around: Sequence[Track], warm: Sequence[Track], frame: Frame) -> None:
        """Point out to the thermal tracker whom it does not see, though that one is before its camera."""
        present = {track.id for track in warm}
        linked = {other for one, other in self._votes.linked.items() if one in present}
        box = self._introductions.next(around, warm, linked, frame)
        if box is not None:
            self._thermal.introduce(box)

    def _joined(self, warm: Sequence[Track], around: Sequence[Track], frame: Frame) -> tuple[Track, ...]:
        """Make one track of those that are one person."""
        number = self._identities.number
        by_heat = _renamed(warm, {track.id: number[THERMAL, track.id] for track in warm})
        by_place = _renamed(around, {track.id: number[PANORAMA, track.id] for track in around})
        calibration = frame.calibrations.get(THERMAL)
        if calibration is not None and THERMAL in frame.images:
            width = frame.images[THERMAL].shape[1]
            by_place = {one: _shown(track, calibration, width) for one, track in by_place.items()}
        both = {one: _merged(by_heat[one], by_place[one]) for one in by_heat.keys() & by_place.keys()}
        joined = by_place | by_heat | both
        return tuple(joined[one] for one in sorted(joined) if not _is_doubtful(joined[one], joined))


def _renamed(tracks: Sequence[Track], number: Mapping[int, int]) -> dict[int, Track]:
    """Give tracks, and those who hide them, other numbers, and list them by these."""
    renamed = (replace(one, id=number[one.id], occluder=number.get(one.occluder or 0)) for one in tracks)
    return {track.id: track for track in renamed}


def _shown(track: Track, calibration: Calibration, width_px: int) -> Track:
    """Put somebody who is seen in the panorama into the thermal image, too."""
    box = thermal_view(track, calibration, width_px)
    return track if box is None else replace(track, boxes={**track.boxes, THERMAL: box})


def _is_doubtful(track: Track, joined: Mapping[int, Track]) -> bool:
    """Tell whether a new track of the panorama is likely one of the thermal image, not linked to it yet."""
    if track.age_s >= DOUBTFUL_S or PANORAMA not in track.boxes:
        return False
    return any(
        other is not track
        and PANORAMA not in other.boxes
        and abs(_bearing(other) - _bearing(track)) < DOUBTFUL_RAD
        for other in joined.values()
    )


def _merged(warm: Track, around: Track) -> Track:
    """Join two tracks of one person; its place is the panorama's while it is seen there, or the surer."""
    better = around if _is_seen(around) or not _is_seen(warm) else warm
    is_near = apartness(warm, around) < 2 * GATE or not _is_seen(warm)
    return replace(
        better,
        boxes={**around.boxes, **(warm.boxes if is_near else {})},
        place=warm.place if is_near and _is_surer(warm, around) else better.place,
        confidence=max(warm.confidence, around.confidence),
        status=warm.status if _is_seen(warm) else around.status,
        age_s=max(warm.age_s, around.age_s),
        occluder=warm.occluder if _is_seen(warm) else around.occluder,
    )


def _is_seen(track: Track) -> bool:
    return track.status is not Status.TOTALLY_OCCLUDED


def _is_surer(warm: Track, around: Track) -> bool:
    """Tell whether the first of two who are both seen is surer of its place."""
    if not (_is_seen(warm) and _is_seen(around)) or warm.place is None or around.place is None:
        return False
    (xx, _, yy), (other_xx, _, other_yy) = warm.place.covariance_m2, around.place.covariance_m2
    return xx + yy < other_xx + other_yy


def _bearing(track: Track) -> float:
    return (
        math.inf if track.place is None else math.atan2(track.place.position_m[1], track.place.position_m[0])
    )
