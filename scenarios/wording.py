"""Events in words."""

from __future__ import annotations

from scenarios.run_events import LogLine


def describe(line: LogLine) -> str:
    """Say what happened in a few words, such as "anna: total occlusion by ben starts"."""
    if line.kind == "mode":
        return f"{line.who}: {line.other}"
    if not line.other:
        return f"{line.who}: {line.kind}"
    what, _, turn = line.kind.rpartition(" ")
    return f"{line.who}: {what} {'with' if what == 'contact' else 'by'} {line.other} {turn}"
