"""The event log of a run: what happens in the world, to the tracks, and in the robot's mind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

from peopleboy.scenarios.files.schema.robot import FaultSpec
from peopleboy.scenarios.loop.faults import active
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.loop.track_events import TrackEvents
from peopleboy.sim.truth.events import EventLog, Move, ThingLog


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLine:
    """One line of events.jsonl.

    Attributes:
        frame: 1, 2, ...
        time_s: [s] since the start.
        kind: what happened; those of `peopleboy.sim.truth.events.Event`, `ThingEvent` and `TrackEvent`,
            "mode", "fault starts" and "fault ends".
        who: a person, a thing, "robot", "track 3", or a kind of fault.
        other: who or what else takes part: an occluder, what is touched, who moves it, the new mode, or under
            which number a track goes on that is somebody known again.
        why: of a change of mode and of a lost track, the reason; of a re-identified one, since when.
        move: of a thing that was moved, from where to where.
    """

    frame: int
    time_s: float
    kind: str
    who: str
    other: str = ""
    why: str = ""
    move: Move | None = None

    def to_json(self) -> dict[str, Any]:
        """Give the line as a JSON object; `why` and `move` are left out where there is none."""
        line = asdict(self)
        if not self.why:
            del line["why"]
        if self.move is None:
            del line["move"]
        return line

    @classmethod
    def from_json(cls, line: Mapping[str, Any]) -> Self:
        """Read back what `to_json` gave.

        Raises:
            TypeError: it is no such object.
        """
        move = line.get("move")
        return cls(**{**line, "move": None if move is None else Move(**move)})


class RunEvents:
    """Collects the events of one tick after another.

    Args:
        faults: that the scenario asks for.
    """

    def __init__(self, faults: Sequence[FaultSpec] = ()) -> None:
        self._faults = faults
        self._broken: tuple[str, ...] = ()
        self._world = EventLog()
        self._things = ThingLog()
        self._tracks = TrackEvents()
        self._mode = ""

    def update(self, tick: Tick) -> list[LogLine]:
        """Return what is new at this tick."""
        time_s, width = tick.truth.time_s, tick.truth.camera.width
        found = [(kind, fault, "", "") for kind, fault in self._of_faults(time_s)]
        found += [(event.kind, event.person, event.other, "") for event in self._world.update(tick.truth)]
        for event in self._tracks.update(tick.tracks, time_s, width):
            by = "" if event.by is None else f"track {event.by}"
            found.append((event.kind, f"track {event.track}", by, event.why))
        if tick.mode != self._mode:
            found.append(("mode", "robot", tick.mode, tick.reason))
        self._mode = tick.mode
        told = [
            LogLine(frame=tick.frame, time_s=time_s, kind=kind, who=who, other=other, why=why)
            for kind, who, other, why in found
        ]
        return told + [
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
        """Yield which faults start and end."""
        before, self._broken = self._broken, tuple(active(self._faults, time_s))
        yield from (("fault starts", fault) for fault in self._broken if fault not in before)
        yield from (("fault ends", fault) for fault in before if fault not in self._broken)
