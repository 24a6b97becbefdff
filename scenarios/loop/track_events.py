"""What happens to tracks: detected, occluded, hidden, lost and why, found again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Box, Status, Track

OUT_SHARE = 0.3  # of a box's width outside the image, from which who is lost there has left it
_INSIDE: Box = (0.0, 0.0, 0.0, 0.0)  # who has no box left no image
PAUSE_S = 1.0  # an occlusion that goes on after less is the same one
KNOWN = "re-identified"
SAME_IOU = 0.5  # of the boxes of one person in two images that follow each other
SAME_M = 0.3  # on the floor, where there are no boxes


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackEvent:
    """One thing that happened to a track.

    Attributes:
        kind: "detected", "occluded", "hidden", "lost" or "re-identified".
        track: its id; of somebody who was known again under another one, the one until then.
        by: id of the track that occludes or hides it, or under which it goes on as somebody known again; None
            if there is none, or none known.
        why: of "lost", the reason as the tracker sees it; of "re-identified", for how long it was gone.
    """

    kind: str
    track: int
    by: int | None = None
    why: str = ""


class TrackEvents:
    """Compares the tracks of one frame after another; tentative ones are none yet, or no longer."""

    def __init__(self) -> None:
        self._now: Mapping[int, Track] = {}
        self._gone_s: dict[int, float] = {}
        self._occluded_s: dict[tuple[int, int], float] = {}

    def update(self, tracks: tuple[Track, ...], time_s: float, width_px: int) -> list[TrackEvent]:
        """Return what is new, track by track."""
        before, every = self._now, {track.id: track for track in tracks}
        self._now = {track.id: track for track in tracks if track.status is not Status.TENTATIVE}
        heirs = self._heirs(before, every)
        known = {was: heir for was, heir in heirs.items() if heir in self._gone_s}
        found: list[TrackEvent] = []
        for number, heir in sorted(known.items()):
            found.append(TrackEvent(kind=KNOWN, track=number, by=heir, why=self._absence(heir, time_s)))
        for number in sorted(before.keys() | self._now.keys()):
            was, now = before.get(number), self._now.get(number)
            if now is not None:
                found += self._seen_again(was, now, time_s, number in known.values())
                found += self._occluded(was, now, time_s)
            elif was is not None:
                self._gone_s.setdefault(number, time_s)
                if number not in known:
                    why = why_lost(every.get(number, was), was, width_px, heirs.get(number))
                    found.append(TrackEvent(kind="lost", track=number, why=why))
        return found

    def _heirs(self, before: Mapping[int, Track], every: Mapping[int, Track]) -> dict[int, int]:
        """Find the tracks that have another number from this frame on: gone where the other one came."""
        gone = [track for number, track in before.items() if number not in every]
        come = [
            track
            for track in self._now.values()
            if track.status is not Status.TOTALLY_OCCLUDED
            and (track.id not in before or track.id in self._gone_s)
        ]
        origins = {now.id: was.id for was in gone for now in come if _is_at_one_place(was, now)}
        return {was: now for now, was in origins.items()}

    def _absence(self, number: int, time_s: float) -> str:
        """Say for how long a track was gone, which it is no more."""
        return f"after {time_s - self._gone_s.pop(number):.1f} s"

    def _seen_again(
        self, was: Track | None, now: Track, time_s: float, is_known: bool
    ) -> Iterator[TrackEvent]:
        if now.status is Status.TOTALLY_OCCLUDED:
            return
        if now.id in self._gone_s:
            yield TrackEvent(kind=KNOWN, track=now.id, why=self._absence(now.id, time_s))
        elif was is None and not is_known:
            yield TrackEvent(kind="detected", track=now.id)

    def _occluded(self, was: Track | None, now: Track, time_s: float) -> Iterator[TrackEvent]:
        if now.status is Status.TOTALLY_OCCLUDED:
            self._gone_s.setdefault(now.id, time_s)
            if was is None or was.status is not Status.TOTALLY_OCCLUDED:
                yield TrackEvent(kind="hidden", track=now.id, by=now.occluder)
        elif now.occluder is not None:
            pair = (now.id, now.occluder)
            if time_s - self._occluded_s.get(pair, -PAUSE_S) >= PAUSE_S:
                yield TrackEvent(kind="occluded", track=now.id, by=now.occluder)
            self._occluded_s[pair] = time_s


def _is_at_one_place(was: Track, now: Track) -> bool:
    """Whether two tracks of two frames that follow each other are on the same person."""
    cameras = was.boxes.keys() & now.boxes.keys()
    if cameras:
        return all(iou(np.array(was.boxes[name]), np.array(now.boxes[name])) > SAME_IOU for name in cameras)
    if was.place is None or now.place is None:
        return False
    return math.dist(was.place.position_m, now.place.position_m) < SAME_M


def why_lost(now: Track, was: Track, width_px: int, heir: int | None = None) -> str:
    """Say why a track was lost, as the tracker sees it.

    Args:
        now: the track as it is, in doubt, or as it was last if it is gone.
        was: as it was before.
        width_px: of the thermal image.
        heir: id of the new track that is there instead; None if there is none.
    """
    if heir is not None:
        return f"track {heir} is there instead"
    left, _, width, _ = now.boxes.get(THERMAL, _INSIDE)
    for out_px, side in ((-left, "left"), (left + width - width_px, "right")):
        if out_px > OUT_SHARE * width:
            return f"left the image on the {side}"
    if was.status is Status.TOTALLY_OCCLUDED:
        by = "" if was.occluder is None else f" by track {was.occluder}"
        return f"hidden{by} for too long to know where"
    if was.status is Status.UNKNOWN:
        return "unknown, as its tracker does not tell"
    return f"not found any more, confidence {now.confidence:.2f}"
