"""Whom the panoramic tracker points out to the thermal one."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Final

from peopleboy.tracker.frame import THERMAL, Calibration, Frame
from peopleboy.tracker.thermal.whereabouts import standing_box
from peopleboy.tracker.track import Box, Status, Track

FARTHEST_M: Final = 7.0
NEAREST_M: Final = 0.5
PAUSE_S: Final = 0.2  # between two introductions of one person
BORDER: Final = 0.02  # share of the image's width at either side in which nobody's middle may be


class Introductions:
    """Remembers who has been pointed out of late."""

    def __init__(self) -> None:
        self._told_s: dict[int, float] = {}

    def next(
        self, around: Sequence[Track], warm: Sequence[Track], linked: Collection[int], frame: Frame
    ) -> Box | None:
        """Give the box in the thermal image of somebody who is before its camera, but not seen by it.

        Args:
            around: tracks of the panoramic tracker.
            warm: those of the thermal one.
            linked: ids of tracks in `around` that the thermal tracker has, too.
            frame: the newest one.

        Returns:
            left, top, width, height [px]; None if there is nobody to point out.
        """
        calibration = frame.calibrations.get(THERMAL)
        if calibration is None or THERMAL not in frame.images:
            return None
        width = frame.images[THERMAL].shape[1]
        for track in around:
            is_due = frame.time_s - self._told_s.get(track.id, -math.inf) >= PAUSE_S
            box = thermal_view(track, calibration, width)
            if is_due and track.id not in linked and box is not None and not _is_taken(box, warm):
                self._told_s[track.id] = frame.time_s
                return box
        return None


def thermal_view(track: Track, calibration: Calibration, width_px: int) -> Box | None:
    """Give the box of a track that is seen elsewhere in a thermal image of this width; None if outside."""
    if track.place is None or track.status is not Status.TRACKED:
        return None
    ahead, aside = track.place.position_m
    if ahead < NEAREST_M or math.hypot(ahead, aside) > FARTHEST_M:
        return None
    box = standing_box(track.place, calibration)
    middle = box[0] + box[2] / 2.0
    return box if BORDER * width_px <= middle <= (1.0 - BORDER) * width_px else None


def _is_taken(box: Box, warm: Sequence[Track]) -> bool:
    """Tell whether somebody whom the thermal tracker has is in the middle of a box."""
    middle = box[0] + box[2] / 2.0
    spans = (track.boxes[THERMAL] for track in warm)
    return any(left - 0.25 * wide <= middle <= left + 1.25 * wide for left, _, wide, _ in spans)
