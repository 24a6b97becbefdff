"""Build the rows of timelines: visibility of people, their tracks, and states of moved objects."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, Final, NamedTuple

import numpy as np

from peopleboy.scenarios.loop.run_events import LogLine, describe_move
from peopleboy.scenarios.report.findings.histories import (
    Floats,
    PersonHistory,
    TrackingState,
    Visibility,
    settle,
    spans,
)
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.report.findings.sentences import listed, seconds, spoken
from peopleboy.tracker.evaluation.occlusion_scores import TOTAL_ENDS, TOTAL_STARTS

ASIDE: Final = ", not counted (too near or too far away)"
_HIDDEN: Final = {Visibility.PARTLY: "partly", Visibility.WHOLLY: "wholly"}


class BarStyle(NamedTuple):
    """Style and text of a bar in a timeline."""

    kind: str
    words: str  # tooltip
    text: str = ""  # label inside the bar, if there is room
    track: int = 0  # number of the track that gives the colour


@dataclass(frozen=True, slots=True)
class TimelineRow:
    """One row of bars (start, end [s] and style) and marks (time [s] and tooltip)."""

    label: str
    bars: tuple[tuple[float, float, BarStyle], ...]
    marks: tuple[tuple[float, str], ...] = ()

    @property
    def words(self) -> str:
        """Text alternative of the row."""
        texts = [f"{start:.1f} to {end:.1f} s {look.words}" for start, end, look in self.bars]
        return f"{self.label}: " + "; ".join(texts + [words for _, words in self.marks])


def truth_row(found: RunFindings, person: PersonHistory) -> TimelineRow:
    """Return the row of a person's true visibility."""

    def look(view: int, is_counted: bool, hider: str) -> BarStyle | None:
        aside, by = "" if is_counted else ASIDE, f"by {spoken(hider)}" if hider else ""
        if view == Visibility.SEEN:
            return BarStyle("seen", "seen", "seen") if is_counted else BarStyle("uncounted", f"seen{aside}")
        kind = _HIDDEN.get(Visibility(view))
        return None if kind is None else BarStyle(kind, f"{kind} hidden {by}".rstrip() + aside, by)

    spans = map(look, person.view.tolist(), person.is_counted.tolist(), _settled_hiders(person))
    return TimelineRow("truth", _bars(found, spans))


def track_row(found: RunFindings, person: PersonHistory) -> TimelineRow:
    """Return the row of a person's tracks."""

    def look(state: int, number: int) -> BarStyle | None:
        others = {
            TrackingState.ADRIFT: BarStyle("adrift", "box not on the person"),
            TrackingState.MISSED: BarStyle("missed", "not found"),
        }
        return (
            BarStyle("on", f"number {number}", str(number), number)
            if state == TrackingState.ON
            else others.get(TrackingState(state))
        )

    marks = [
        (
            change.time_s,
            f"{change.time_s:.1f} s: number {change.old} becomes {change.new}"
            + (f", which was {spoken(change.taken_from)}'s" if change.taken_from else ""),
        )
        for change in found.changes
        if change.person == person.name
    ]
    changed = {time_s for time_s, _ in marks}
    marks += [
        (one.time_s, f"{one.time_s:.1f} s: has number {one.number}, which was {spoken(one.giver)}'s")
        for one in found.transfers
        if one.receiver == person.name and one.time_s not in changed
    ]
    spans = map(look, person.state.tolist(), person.track.tolist())
    return TimelineRow("track", _bars(found, spans), tuple(sorted(marks)))


def false_track_row(found: RunFindings) -> TimelineRow:
    """Return the row of tracks that are never on a person."""
    bars = []
    for stray in found.false_tracks:
        look = BarStyle("stray", f"number {stray.track}", str(stray.track))
        bars += _bars(found, (look if is_shown else None for is_shown in found.shown[stray.track]))
    return TimelineRow("no person", tuple(bars))


def mode_row(found: RunFindings) -> TimelineRow:
    """Return the row of the robot's modes; empty if it has only one."""
    modes = found.files.robot["mode"].to_pylist()
    names = list(dict.fromkeys(modes))
    why, reason, spans = (
        {line.frame: line.why for line in found.run.events if line.kind == "mode"},
        "",
        [],
    )
    for frame, mode in enumerate(modes, start=1):
        reason = why.get(frame, reason)
        spans.append(
            BarStyle(f"mode{names.index(mode) % 4}", f"{mode}{': ' if reason else ''}{reason}", mode)
        )
    return TimelineRow("robot", _bars(found, spans) if len(names) > 1 else ())


def hidden_words(found: RunFindings, person: PersonHistory) -> str:
    """Describe the times at which a person was hidden: occluder, share, and time of full occlusion."""
    rate, texts = found.run.rate_hz, []
    for span in spans(np.isin(person.view, tuple(_HIDDEN))):
        if span.value:
            here = slice(span.start, span.end)
            by = listed([spoken(name) for name in dict.fromkeys(person.hider[here]) if name])
            wholly_s = _wholly_hidden(person.occluded[here]) / rate
            how = (
                f"wholly for {seconds(wholly_s)}"
                if wholly_s
                else f"to {np.nanmax(person.occluded[here]):.0%}"
            )
            when = f"{'in all ' if wholly_s else ''}{span.start / rate:.1f} to {seconds(span.end / rate)}"
            texts.append(f"{how}{' by ' if by else ''}{by} ({when})")
    return f"Hidden {', '.join(texts)}." if texts else ""


def _wholly_hidden(occluded: Floats) -> int:
    """Count the frames of full occlusion as the occlusion scores do."""
    starts = np.flatnonzero(occluded > TOTAL_STARTS)
    return int((occluded[starts[0] :] >= TOTAL_ENDS).sum()) if len(starts) else 0


def _bars(found: RunFindings, spans: Iterator[BarStyle | None] | Sequence[BarStyle | None]) -> Any:
    """Merge consecutive frames of equal style into bars."""
    bars, start, rate = [], 0, found.run.rate_hz
    for look, alike in groupby(spans):
        end = start + len(list(alike))
        if look is not None:
            bars.append((start / rate, end / rate, look))
        start = end
    return tuple(bars)


def _settled_hiders(person: PersonHistory) -> list[str]:
    """Return the main occluder of each frame, without brief occlusions."""
    hiders = list(person.hider)
    for stretch in spans(person.view * 2 + ~person.is_counted):
        here = hiders[stretch.start : stretch.end]
        names = list(dict.fromkeys(here))
        codes = settle(np.array([names.index(name) + 1 for name in here], np.int64), 3)
        most = person.hider_in(stretch.start, stretch.end)
        hiders[stretch.start : stretch.end] = [names[code - 1] if code else most for code in codes]
    return hiders


THING: Final = "thing "
"""Prefix of the kinds of events of objects."""
_APPEARED, _VANISHED = f"{THING}appeared", f"{THING}vanished"
_NO_PERSON: Final = "no person"
_HANDS: Final = ("mode1", "mode2", "mode3")  # bar styles of people who move objects


def thing_rows(found: RunFindings) -> list[TimelineRow]:
    """Return a row for each moved object, in the order of their first events: resting and moved times."""
    lines = [line for line in found.run.events if line.kind.startswith(THING)]
    hands = list(dict.fromkeys(line.other for line in lines))
    return [
        _row(name, [line for line in lines if line.who == name], hands, found.run.frames / found.run.rate_hz)
        for name in dict.fromkeys(line.who for line in lines)
    ]


def _row(name: str, lines: Sequence[LogLine], hands: Sequence[str], end_s: float) -> TimelineRow:
    changes = [line for line in lines if line.kind in (_APPEARED, _VANISHED)]
    is_there = not changes or changes[0].kind == _VANISHED
    bars, since_s = list[tuple[float, float, BarStyle]](), 0.0

    def stand(until_s: float) -> None:
        if is_there and until_s > since_s:
            bars.append((since_s, until_s, BarStyle("stands", "stands")))

    for line in lines:
        from_s, to_s = (line.time_s, line.time_s) if line.move is None else (line.move.from_s, line.move.to_s)
        stand(from_s)
        if line.move is not None:
            who = spoken(line.other) or _NO_PERSON
            kind = _HANDS[hands.index(line.other) % len(_HANDS)]
            bars.append((from_s, to_s, BarStyle(kind, f"moved {describe_move(line.move)} by {who}", who)))
        is_there, since_s = line.kind != _VANISHED, to_s
    stand(end_s)
    return TimelineRow(spoken(name), tuple(bars), tuple(_mark(line) for line in changes))


def _mark(line: LogLine) -> tuple[float, str]:
    by = f", by {spoken(line.other)}" if line.other else ""
    return line.time_s, f"{line.time_s:.1f} s: {line.kind.removeprefix(THING)}{by}"
