"""What happens to tracks: detected, occluded, hidden, lost and why, found again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Box, Status, Track

OUT_SHARE = 0.3  # of a box's width outside the image, from which who is lost there has left it
_INSIDE: Box = (0.0, 0.0, 0.0, 0.0)  # who has no box left no image
PAUSE_S = 1.0  # an occlusion that goes on after less is the same one


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackEvent:
    """One thing that happened to a track.

    Attributes:
        kind: "detected", "occluded", "hidden", "lost" or "re-identified".
        track: its id.
        by: id of the track that occludes or hides it; None if nobody does, or nobody known.
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
        before, doubtful = self._now, {track.id: track for track in tracks}
        self._now = {track.id: track for track in tracks if track.status is not Status.TENTATIVE}
        found: list[TrackEvent] = []
        for number in sorted(before.keys() | self._now.keys()):
            was, now = before.get(number), self._now.get(number)
            if now is not None:
                found += self._seen_again(was, now, time_s)
                found += self._occluded(was, now, time_s)
            elif was is not None:
                self._gone_s.setdefault(number, time_s)
                why = why_lost(doubtful.get(number, was), was, width_px)
                found.append(TrackEvent(kind="lost", track=number, why=why))
        return found

    def _seen_again(self, was: Track | None, now: Track, time_s: float) -> Iterator[TrackEvent]:
        if now.status is Status.TOTALLY_OCCLUDED:
            return
        gone_s = self._gone_s.pop(now.id, None)
        if gone_s is not None:
            yield TrackEvent(kind="re-identified", track=now.id, why=f"after {time_s - gone_s:.1f} s")
        elif was is None:
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


def why_lost(now: Track, was: Track, width_px: int) -> str:
    """Say why a track was lost, as the tracker sees it.

    Args:
        now: the track as it is, in doubt, or as it was last if it is gone.
        was: as it was before.
        width_px: of the thermal image.
    """
    left, _, width, _ = now.boxes.get(THERMAL, _INSIDE)
    for out_px, side in ((-left, "left"), (left + width - width_px, "right")):
        if out_px > OUT_SHARE * width:
            return f"left the image on the {side}"
    if was.status is Status.TOTALLY_OCCLUDED:
        by = "" if was.occluder is None else f" by track {was.occluder}"
        return f"hidden{by} for too long to know where"
    if was.status is Status.UNKNOWN:
        return "unknown, as its tracker does not tell"
    return f"the contour is gone, confidence {now.confidence:.2f}"
