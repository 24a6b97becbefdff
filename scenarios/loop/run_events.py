"""Log the events of a run: what happens in the world, to the tracks, and to the behaviour; and word them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

from peopleboy.scenarios.files.scenario_file import FaultSpec
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


_WORTH_DEG = 10.0


def describe(line: LogLine) -> str:
    """Say what happened in a few words, such as "anna: total occlusion by ben starts"."""
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
    """Say what became of a thing, such as "chair_1: moved 1.10 m by anna"."""
    what = line.kind.removeprefix("thing ")
    how = "" if line.move is None else f" {describe_move(line.move)}"
    by = {"appeared": ", brought by", "vanished": ", taken by"}.get(what, " by")
    return f"{line.who}: {what}{how}{f'{by} {line.other}' if line.other else ''}"


def describe_move(move: Move) -> str:
    """Say how far something was moved, such as "1.10 m" or "0.66 m, turned 90°"."""
    turn = f", turned {abs(move.turned_deg):.0f}°" if abs(move.turned_deg) >= _WORTH_DEG else ""
    return f"{move.distance_m:.2f} m{turn}"


def describe_fully(line: LogLine) -> str:
    """Say what happened and why, such as "track 2: lost (left the image on the left)"."""
    return f"{describe(line)} ({line.why})" if line.why else describe(line)
