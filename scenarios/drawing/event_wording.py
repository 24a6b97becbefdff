"""Events in words."""

from __future__ import annotations

from peopleboy.scenarios.loop.run_events import LogLine


def describe(line: LogLine) -> str:
    """Say what happened in a few words, such as "anna: total occlusion by ben starts"."""
    if line.kind == "mode":
        return f"{line.who}: {line.other}"
    if not line.other:
        return f"{line.who}: {line.kind}"
    if line.kind in ("occluded", "hidden"):
        return f"{line.who}: {line.kind} by {line.other}"
    what, _, turn = line.kind.rpartition(" ")
    return f"{line.who}: {what} {'with' if what == 'contact' else 'by'} {line.other} {turn}"


def describe_fully(line: LogLine) -> str:
    """Say what happened and why, such as "track 2: lost (left the image on the left)"."""
    return f"{describe(line)} ({line.why})" if line.why else describe(line)
