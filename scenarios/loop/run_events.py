"""Log and describe the events of a run: events in the world, of the tracks, and of the behaviour."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np

from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.faults import active
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.sim.truth.events import EventLog, Move, ThingLog
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Box, Status, Track

OUT_SHARE = 0.3  # share of a box's width outside the image from which a lost track has left the image
_INSIDE: Box = (0.0, 0.0, 0.0, 0.0)  # stands for a missing box, which has not left the image
PAUSE_S = 1.0  # an occlusion that resumes after a shorter gap is the same one
KNOWN = "re-identified"
SAME_IOU = 0.5  # minimum IoU of one person's boxes in two consecutive images
SAME_M = 0.3  # maximum floor distance in two consecutive images, for tracks without boxes


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackEvent:
    """One event of a track.

    Attributes:
        kind: "detected", "occluded", "hidden", "lost" or "re-identified".
        track: id of the track; for a person re-identified under another id, the earlier id.
        by: id of the track that occludes or hides it, or the new id after a re-identification; None if there
            is none, or it is unknown.
        why: for "lost", the reason according to the tracker; for "re-identified", the time of absence.
    """

    kind: str
    track: int
    by: int | None = None
    why: str = ""


class TrackEvents:
    """Compare the tracks of consecutive frames; tentative tracks are ignored."""

    def __init__(self) -> None:
        self._now: Mapping[int, Track] = {}
        self._gone_s: dict[int, float] = {}
        self._occluded_s: dict[tuple[int, int], float] = {}

    def update(self, tracks: tuple[Track, ...], time_s: float, width_px: int) -> list[TrackEvent]:
        """Return the new events, track by track."""
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
        """Map each track id that vanished to a new id at the same place."""
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
        """Describe how long a track was gone, and forget its absence."""
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
    """Return whether two tracks of two consecutive frames are on the same person."""
    cameras = was.boxes.keys() & now.boxes.keys()
    if cameras:
        return all(iou(np.array(was.boxes[name]), np.array(now.boxes[name])) > SAME_IOU for name in cameras)
    if was.place is None or now.place is None:
        return False
    return math.dist(was.place.position_m, now.place.position_m) < SAME_M


def why_lost(now: Track, was: Track, width_px: int, heir: int | None = None) -> str:
    """Describe why a track was lost, according to the tracker.

    Args:
        now: the track with its new status, or its last state if it is gone.
        was: the track in the frame before.
        width_px: width of the thermal image.
        heir: id of a new track in its place; None for none.
    """
    if heir is not None:
        return f"replaced by track {heir}"
    left, _, width, _ = now.boxes.get(THERMAL, _INSIDE)
    for out_px, side in ((-left, "left"), (left + width - width_px, "right")):
        if out_px > OUT_SHARE * width:
            return f"left the image on the {side}"
    if was.status is Status.TOTALLY_OCCLUDED:
        by = "" if was.occluder is None else f" by track {was.occluder}"
        return f"occluded{by} for too long"
    if was.status is Status.UNKNOWN:
        return "unknown, because its tracker gives no reason"
    return f"not detected any more, confidence {now.confidence:.2f}"


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLine:
    """One line of events.jsonl.

    Attributes:
        frame: 1, 2, ...
        time_s: [s] since the start.
        kind: kind of event: one of `peopleboy.sim.truth.events.Event`, `ThingEvent` and `TrackEvent`, or
            "mode", "fault starts", "fault ends", "camera fails", "camera works".
        who: a person, an object, "robot", "track 3", a kind of fault, or a camera.
        other: the other party: an occluder, a touched object, the person who moves it, the new mode, or the
            new id of a re-identified track.
        why: reason of a change of mode, of a failed camera or of a lost track; time of absence of a
            re-identified track.
        move: movement of a moved object.
    """

    frame: int
    time_s: float
    kind: str
    who: str
    other: str = ""
    why: str = ""
    move: Move | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the line as a JSON object; `why` and `move` are omitted if empty."""
        line = asdict(self)
        if not self.why:
            del line["why"]
        if self.move is None:
            del line["move"]
        return line

    @classmethod
    def from_json(cls, line: Mapping[str, Any]) -> Self:
        """Read a line from the output of `to_json`.

        Raises:
            TypeError: the object does not have this form.
        """
        move = line.get("move")
        found = cls(**{**line, "move": None if move is None else Move(**move)})
        words = (found.kind, found.who, found.other, found.why)
        if not isinstance(found.frame, int) or not isinstance(found.time_s, int | float):
            raise TypeError("frame and time_s must be numbers")
        if not all(isinstance(word, str) for word in words):
            raise TypeError("kind, who, other and why must be text")
        return found


class RunEvents:
    """Collect the events of consecutive ticks.

    Args:
        faults: faults of the scenario.
    """

    def __init__(self, faults: Sequence[FaultSpec] = ()) -> None:
        self._faults = faults
        self._broken: tuple[str, ...] = ()
        self._failed: Mapping[str, str] = {}
        self._world = EventLog()
        self._things = ThingLog()
        self._tracks = TrackEvents()
        self._mode = ""

    def update(self, tick: Tick) -> list[LogLine]:
        """Return the new events at this tick."""
        time_s, width = tick.truth.time_s, tick.truth.camera.width
        found = [(kind, fault, "", "") for kind, fault in self._of_faults(time_s)]
        found += [(kind, camera, "", why) for kind, camera, why in self._of_cameras(tick.failed)]
        found += [(event.kind, event.person, event.other, "") for event in self._world.update(tick.truth)]
        for event in self._tracks.update(tick.tracks, time_s, width):
            by = "" if event.by is None else f"track {event.by}"
            found.append((event.kind, f"track {event.track}", by, event.why))
        if tick.mode != self._mode:
            found.append(("mode", "robot", tick.mode, tick.reason))
        self._mode = tick.mode
        lines = [
            LogLine(frame=tick.frame, time_s=time_s, kind=kind, who=who, other=other, why=why)
            for kind, who, other, why in found
        ]
        return lines + [
            LogLine(
                frame=tick.frame,
                time_s=time_s,
                kind=event.kind,
                who=event.thing,
                other=event.by,
                move=event.move,
            )
            for event in self._things.update(tick.truth)
        ]

    def _of_faults(self, time_s: float) -> Iterator[tuple[str, str]]:
        """Yield the faults that start or end."""
        before, self._broken = self._broken, tuple(active(self._faults, time_s))
        yield from (("fault starts", fault) for fault in self._broken if fault not in before)
        yield from (("fault ends", fault) for fault in before if fault not in self._broken)

    def _of_cameras(self, failed: Mapping[str, str]) -> Iterator[tuple[str, str, str]]:
        """Yield the cameras that fail or work again."""
        before, self._failed = self._failed, failed
        yield from (("camera fails", name, why) for name, why in failed.items() if name not in before)
        yield from (("camera works", name, "") for name in before if name not in failed)


_WORTH_DEG = 10.0


def describe(line: LogLine) -> str:
    """Describe an event in a few words, such as "anna: total occlusion by ben starts"."""
    if line.kind == "mode":
        return f"{line.who}: {line.other}"
    if line.kind.startswith("fault "):
        return f"fault {line.who} {line.kind.removeprefix('fault ')}"
    if line.kind.startswith("thing "):
        return _describe_thing(line)
    if not line.other:
        return f"{line.who}: {line.kind}"
    if line.kind == "re-identified":
        return f"{line.who}: {line.kind} as {line.other}"
    if line.kind in ("occluded", "hidden"):
        return f"{line.who}: {line.kind} by {line.other}"
    what, _, turn = line.kind.rpartition(" ")
    return f"{line.who}: {what} {'with' if what == 'contact' else 'by'} {line.other} {turn}"


def _describe_thing(line: LogLine) -> str:
    """Describe an event of an object, such as "chair_1: moved 1.10 m by anna"."""
    what = line.kind.removeprefix("thing ")
    how = "" if line.move is None else f" {describe_move(line.move)}"
    by = {"appeared": ", brought by", "vanished": ", taken by"}.get(what, " by")
    return f"{line.who}: {what}{how}{f'{by} {line.other}' if line.other else ''}"


def describe_move(move: Move) -> str:
    """Describe how far an object was moved, such as "1.10 m" or "0.66 m, turned 90°"."""
    turn = f", turned {abs(move.turned_deg):.0f}°" if abs(move.turned_deg) >= _WORTH_DEG else ""
    return f"{move.distance_m:.2f} m{turn}"


def describe_fully(line: LogLine) -> str:
    """Describe an event and its reason, such as "track 2: lost (left the image on the left)"."""
    return f"{describe(line)} ({line.why})" if line.why else describe(line)
