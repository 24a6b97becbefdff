"""Events in words."""

from __future__ import annotations

from scenarios.run_events import LogLine

_JOINED = {"occlusion": " by ", "total": " by ", "contact": " with "}


def describe(line: LogLine) -> str:
    """Say what happened in a few words, such as "anna: occlusion starts by ben"."""
    if line.kind == "mode":
        return f"{line.who}: {line.other}"
    if not line.other:
        return f"{line.who}: {line.kind}"
    return f"{line.who}: {line.kind}{_JOINED.get(line.kind.split()[0], ', ')}{line.other}"
