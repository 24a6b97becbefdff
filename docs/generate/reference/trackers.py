"""Generate the table of trackers from their registry."""

from __future__ import annotations

from docs.generate.markdown import table
from peopleboy.tracker.trackers import TRACKERS


def trackers() -> str:
    """List every tracker with its scope and description."""
    rows = [(f"`{name}`", entry.scope, entry.summary) for name, entry in TRACKERS.shipped.items()]
    return table(("`--tracker`", "source", "description"), rows)
