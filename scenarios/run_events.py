"""The event log of a run: what happens in the world, to the tracks, and in the robot's mind."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from scenarios.loop import Tick
from sim.events import EventLog
from tracker.track import Status


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLine:
    """One line of events.jsonl.

    Attributes:
        frame: 1, 2, ...
        time_s: [s] since the start.
        kind: what happened; those of `sim.events.Event`, and "detected", "lost" and "mode".
        who: a person, "robot", or "track 3".
        other: who or what else takes part: an occluder, what is touched, or the new mode.
        why: of a change of mode, its reason.
    """

    frame: int
    time_s: float
    kind: str
    who: str
    other: str = ""
    why: str = ""

    def to_json(self) -> dict[str, Any]:
        """Give the line as a JSON object; `why` is left out where there is none."""
        line = asdict(self)
        if not self.why:
            del line["why"]
        return line


class RunEvents:
    """Collects the events of one tick after another."""

    def __init__(self) -> None:
        self._world = EventLog()
        self._tracks: frozenset[int] = frozenset()
        self._mode = ""

    def update(self, tick: Tick) -> list[LogLine]:
        """Return what is new at this tick."""
        found = [(event.kind, event.person, event.other) for event in self._world.update(tick.truth)]
        tracks = frozenset(track.id for track in tick.tracks if track.status is not Status.TENTATIVE)
        found += [("detected", f"track {number}", "") for number in sorted(tracks - self._tracks)]
        found += [("lost", f"track {number}", "") for number in sorted(self._tracks - tracks)]
        time_s = tick.truth.time_s
        lines = [
            LogLine(frame=tick.frame, time_s=time_s, kind=kind, who=who, other=other)
            for kind, who, other in found
        ]
        if tick.mode != self._mode:
            lines.append(
                LogLine(
                    frame=tick.frame,
                    time_s=time_s,
                    kind="mode",
                    who="robot",
                    other=tick.mode,
                    why=tick.reason,
                )
            )
        self._tracks, self._mode = tracks, tick.mode
        return lines
