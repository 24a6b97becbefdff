"""Handover: a person keeps one id from the thermal image through the panorama and back."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final, Protocol

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.contour.box_interaction import standing_box
from peopleboy.tracker.contour.explanation import ContourExplanation
from peopleboy.tracker.frame import PANORAMA, THERMAL, Frame, check_frame
from peopleboy.tracker.fusion.fused_explanations import BothExplanations
from peopleboy.tracker.fusion.handover_links import (
    GATE,
    Departures,
    Identities,
    LinkEvidence,
    is_same_way,
    is_seen,
    mahalanobis2,
    pairs,
)
from peopleboy.tracker.panoramic.people.panoramic_tracker import PanoramicTracker
from peopleboy.tracker.track import Box, Status, Track

# Hints from the panoramic tracker to the thermal one.

FARTHEST_M: Final = 7.0
NEAREST_M: Final = 0.5
PAUSE_S: Final = 0.2  # least time between two hints for one person
BORDER: Final = 0.02  # margin, in image widths, in which the middle of a hinted person may not lie


class Introductions:
    """Remembers recent hints."""

    def __init__(self) -> None:
        self._reported_s: dict[int, float] = {}

    def next(
        self, around: Sequence[Track], warm: Sequence[Track], linked: Collection[int], frame: Frame
    ) -> Box | None:
        """Return the thermal box of a person who is in front of the thermal camera, but not tracked by it.

        Args:
            around: tracks of the panoramic tracker.
            warm: tracks of the thermal tracker.
            linked: ids of tracks in `around` that the thermal tracker also has.
            frame: the newest frame.

        Returns:
            left, top, width, height [px]; None if there is no hint.
        """
        calibration = frame.calibrations.get(THERMAL)
        if calibration is None or THERMAL not in frame.images:
            return None
        width = frame.images[THERMAL].shape[1]
        for track in around:
            is_due = frame.time_s - self._reported_s.get(track.id, -math.inf) >= PAUSE_S
            box = thermal_view(track, calibration, width)
            if is_due and track.id not in linked and box is not None and not _is_taken(box, warm):
                self._reported_s[track.id] = frame.time_s
                return box
        return None


def thermal_view(track: Track, calibration: Calibration, width_px: int) -> Box | None:
    """Return the box of a panoramic track in a thermal image of this width; None if outside."""
    if track.place is None or track.status is not Status.TRACKED:
        return None
    ahead, aside = track.place.position_m
    if ahead < NEAREST_M or math.hypot(ahead, aside) > FARTHEST_M:
        return None
    box = standing_box(track.place, calibration)
    middle = box[0] + box[2] / 2.0
    return box if BORDER * width_px <= middle <= (1.0 - BORDER) * width_px else None


def _is_taken(box: Box, warm: Sequence[Track]) -> bool:
    """Return whether a track of the thermal tracker is in the middle of a box."""
    middle = box[0] + box[2] / 2.0
    spans = (track.boxes[THERMAL] for track in warm)
    return any(left - 0.25 * wide <= middle <= left + 1.25 * wide for left, _, wide, _ in spans)


# Merging two tracks of one person.

DOUBTFUL_S: Final = 0.7


def joined(warm: Mapping[int, Track], around: Mapping[int, Track], frame: Frame) -> tuple[Track, ...]:
    """Merge tracks with the same number, ordered by number.

    Args:
        warm: tracks of the thermal tracker, by number.
        around: tracks of the panoramic tracker, by number.
        frame: the newest frame.
    """
    calibration = frame.calibrations.get(THERMAL)
    if calibration is not None and THERMAL in frame.images:
        width = frame.images[THERMAL].shape[1]
        around = {number: _shown(track, calibration, width) for number, track in around.items()}
    both = {number: _merged(warm[number], around[number]) for number in warm.keys() & around.keys()}
    tracks = {**around, **warm, **both}
    return tuple(tracks[number] for number in sorted(tracks) if not _is_doubtful(tracks[number], tracks))


def renamed(tracks: Mapping[int, Track]) -> dict[int, Track]:
    """Return tracks with their ids and occluders replaced by the shared numbers."""
    number = {track.id: shared for shared, track in tracks.items()}
    return {
        shared: replace(track, id=shared, occluder=number.get(track.occluder or 0))
        for shared, track in tracks.items()
    }


def _shown(track: Track, calibration: Calibration, width_px: int) -> Track:
    """Project a person seen in the panorama into the thermal image."""
    box = thermal_view(track, calibration, width_px)
    return track if box is None else replace(track, boxes={**track.boxes, THERMAL: box})


def _is_doubtful(track: Track, tracks: Mapping[int, Track]) -> bool:
    """Return whether a new panoramic track probably is a thermal track that is not linked to it yet."""
    if track.age_s >= DOUBTFUL_S or PANORAMA not in track.boxes:
        return False
    return any(PANORAMA not in other.boxes and is_same_way(track, other) for other in tracks.values())


def _merged(warm: Track, around: Track) -> Track:
    """Merge two tracks of one person, with the panorama's position while seen there, else the surer one."""
    better = around if is_seen(around) or not is_seen(warm) else warm
    is_near = mahalanobis2(warm, around) < 2 * GATE or not is_seen(warm)
    return replace(
        better,
        boxes={**around.boxes, **(warm.boxes if is_near else {})},
        place=warm.place if is_near and _is_surer(warm, around) else better.place,
        confidence=max(warm.confidence, around.confidence),
        status=warm.status if is_seen(warm) else around.status,
        age_s=max(warm.age_s, around.age_s),
        occluder=warm.occluder if is_seen(warm) else around.occluder,
    )


def _is_surer(warm: Track, around: Track) -> bool:
    """Return whether the first of two visible tracks has the more certain position."""
    if not (is_seen(warm) and is_seen(around)) or warm.place is None or around.place is None:
        return False
    (xx, _, yy), (other_xx, _, other_yy) = warm.place.covariance_m2, around.place.covariance_m2
    return xx + yy < other_xx + other_yy


NEEDED_VOTES: Final = 3
MOST_VOTES: Final = 15


class Ahead(Protocol):
    """A tracker in the thermal image and possibly others."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the required cameras."""
        ...

    @property
    def explanation(self) -> ContourExplanation:
        """The state behind its tracks."""
        ...

    def introduce(self, box: Box) -> None:
        """Report that a person is at this box [px] of the thermal image in the next frame."""
        ...

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks."""
        ...


class HandoverTracker:
    """Two trackers with shared ids: a thermal one ahead, and a panoramic one all round the robot.

    Tracks at the same position for several frames are one person. The panoramic tracker gives the thermal
    tracker a hint when a person enters the thermal image, so that the id is known from the first frame on.

    Args:
        thermal: tracker in the thermal image.
        panoramic: tracker in the panorama.

    Source: thesis, section 8.2, which proposes to learn people in the thermal image and to track them with
    that model in the omnidirectional image.
    """

    def __init__(self, thermal: Ahead, panoramic: PanoramicTracker) -> None:
        self._thermal, self._panoramic = thermal, panoramic
        self._votes = LinkEvidence(NEEDED_VOTES, MOST_VOTES)
        self._identities = Identities()
        self._departures = Departures()
        self._introductions = Introductions()
        self._warm: tuple[Track, ...] = ()

    @property
    def cameras(self) -> tuple[str, ...]:
        """The cameras of both trackers."""
        return (*self._thermal.cameras, *self._panoramic.cameras)

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse a panoramic camera that its tracker was not trained on, before the first frame.

        Raises:
            BadInput: another camera, or one that is not panoramic.
        """
        self._panoramic.check_cameras(calibrations)

    @property
    def explanation(self) -> BothExplanations:
        """The explanations of both trackers."""
        shown = {track.id: number for number, track in self._identities.of(THERMAL, self._warm).items()}
        return BothExplanations.of(self._thermal.explanation, self._panoramic.explanation, shown)

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks.

        Raises:
            BadInput: raised by either tracker.
        """
        check_frame(frame)
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
        """Return all tracks by number; two that have agreed for long enough share one."""
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
        """Number the new tracks of a camera by agreeing tracks of the other camera, or by last positions."""
        known = {one: (other, mate) for one, mate in mates.items()}
        guess = partial(self._departures.who, camera=camera, others=self._identities.of(other, others))
        self._identities.name(camera, tracks, known, guess)

    def _introduce(self, around: Sequence[Track], warm: Sequence[Track], frame: Frame) -> None:
        """Give the thermal tracker a hint for a person in front of its camera that it has not found."""
        present = {track.id for track in warm}
        linked = {other for one, other in self._votes.linked.items() if one in present}
        box = self._introductions.next(around, warm, linked, frame)
        if box is not None:
            self._thermal.introduce(box)
