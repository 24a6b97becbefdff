"""The timeline of things: where they stand, and who has them in their hands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from markupsafe import Markup

from peopleboy.scenarios.loop.run_events import LogLine, describe_move
from peopleboy.scenarios.report.charts.timelines import Look, TimelineRow, draw_rows
from peopleboy.scenarios.report.findings.sentences import spoken
from peopleboy.scenarios.report.findings.summary import RunFindings

THING: Final = "thing "
"""How the kinds of events of things begin."""

_APPEARED, _VANISHED = f"{THING}appeared", f"{THING}vanished"
_NOBODY: Final = "nobody"
_HANDS: Final = ("mode1", "mode2", "mode3")  # looks of those who move things


def draw_things(found: RunFindings, label: str) -> Markup:
    """Draw a row for each thing that something happened to; nothing if there is none."""
    rows = thing_rows(found)
    return draw_rows(found, rows, "Things", label, has_axis=True) if rows else Markup("")


def thing_rows(found: RunFindings) -> list[TimelineRow]:
    """Tell of each thing, in the order of what happened first, when it stood and when somebody moved it."""
    lines = [line for line in found.run.events if line.kind.startswith(THING)]
    hands = list(dict.fromkeys(line.other for line in lines))
    return [
        _row(name, [line for line in lines if line.who == name], hands, found.run.frames / found.run.rate_hz)
        for name in dict.fromkeys(line.who for line in lines)
    ]


def _row(name: str, lines: Sequence[LogLine], hands: Sequence[str], end_s: float) -> TimelineRow:
    changes = [line for line in lines if line.kind in (_APPEARED, _VANISHED)]
    is_there = not changes or changes[0].kind == _VANISHED
    bars, since_s = list[tuple[float, float, Look]](), 0.0

    def stand(until_s: float) -> None:
        if is_there and until_s > since_s:
            bars.append((since_s, until_s, Look("stands", "stands")))

    for line in lines:
        from_s, to_s = (line.time_s, line.time_s) if line.move is None else (line.move.from_s, line.move.to_s)
        stand(from_s)
        if line.move is not None:
            who = spoken(line.other) or _NOBODY
            kind = _HANDS[hands.index(line.other) % len(_HANDS)]
            bars.append((from_s, to_s, Look(kind, f"moved {describe_move(line.move)} by {who}", who)))
        is_there, since_s = line.kind != _VANISHED, to_s
    stand(end_s)
    return TimelineRow(spoken(name), tuple(bars), tuple(_mark(line) for line in changes))


def _mark(line: LogLine) -> tuple[float, str]:
    by = f", by {spoken(line.other)}" if line.other else ""
    return line.time_s, f"{line.time_s:.1f} s: {line.kind.removeprefix(THING)}{by}"
