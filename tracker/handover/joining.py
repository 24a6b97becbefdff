"""One track of two that are one person."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from peopleboy.tracker.frame import PANORAMA, THERMAL, Calibration, Frame
from peopleboy.tracker.handover.introductions import thermal_view
from peopleboy.tracker.handover.links import GATE, apartness, is_same_way, is_seen
from peopleboy.tracker.track import Track

DOUBTFUL_S: Final = 0.7


def joined(warm: Mapping[int, Track], around: Mapping[int, Track], frame: Frame) -> tuple[Track, ...]:
    """Make one track of those that have one number, in the order of the numbers.

    Args:
        warm: tracks of the thermal tracker, by their numbers.
        around: those of the panoramic one.
        frame: the newest one.
    """
    calibration = frame.calibrations.get(THERMAL)
    if calibration is not None and THERMAL in frame.images:
        width = frame.images[THERMAL].shape[1]
        around = {number: _shown(track, calibration, width) for number, track in around.items()}
    both = {number: _merged(warm[number], around[number]) for number in warm.keys() & around.keys()}
    tracks = {**around, **warm, **both}
    return tuple(tracks[number] for number in sorted(tracks) if not _is_doubtful(tracks[number], tracks))


def renamed(tracks: Mapping[int, Track]) -> dict[int, Track]:
    """Give tracks, and those who hide them, the numbers by which they are listed."""
    number = {track.id: shared for shared, track in tracks.items()}
    return {
        shared: replace(track, id=shared, occluder=number.get(track.occluder or 0))
        for shared, track in tracks.items()
    }


def _shown(track: Track, calibration: Calibration, width_px: int) -> Track:
    """Put somebody who is seen in the panorama into the thermal image, too."""
    box = thermal_view(track, calibration, width_px)
    return track if box is None else replace(track, boxes={**track.boxes, THERMAL: box})


def _is_doubtful(track: Track, tracks: Mapping[int, Track]) -> bool:
    """Tell whether a new track of the panorama is likely one of the thermal image, not linked to it yet."""
    if track.age_s >= DOUBTFUL_S or PANORAMA not in track.boxes:
        return False
    return any(PANORAMA not in other.boxes and is_same_way(track, other) for other in tracks.values())


def _merged(warm: Track, around: Track) -> Track:
    """Join two tracks of one person; its place is the panorama's while it is seen there, or the surer."""
    better = around if is_seen(around) or not is_seen(warm) else warm
    is_near = apartness(warm, around) < 2 * GATE or not is_seen(warm)
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
    """Tell whether the first of two who are both seen is surer of its place."""
    if not (is_seen(warm) and is_seen(around)) or warm.place is None or around.place is None:
        return False
    (xx, _, yy), (other_xx, _, other_yy) = warm.place.covariance_m2, around.place.covariance_m2
    return xx + yy < other_xx + other_yy
