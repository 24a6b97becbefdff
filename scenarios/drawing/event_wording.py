"""Events in words."""

from __future__ import annotations

from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.sim.truth.events import Move

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
