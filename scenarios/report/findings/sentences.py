"""Names, lists and counts as a sentence wants them."""

from __future__ import annotations

from collections.abc import Sequence


def spoken(name: str) -> str:
    """Write a key of a file as a name in a sentence: Anna, Floor lamp 1."""
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]


def listed(words: Sequence[str]) -> str:
    """Join words: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def times(count: int) -> str:
    """Say how often."""
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def seconds(time_s: float) -> str:
    """Write a time or a duration so that its unit stays on the line."""
    return f"{time_s:.1f}\u00a0s"
