"""Words of messages that every room needs: counts, and hints at what was probably meant."""

import difflib
from collections.abc import Iterable

_LONGEST = 100  # letters that are compared, as the time grows with their square


def counted(count: int, one: str, several: str = "") -> str:
    """Write a count with its noun, such as "1 frame", "2 frames", "3 people"."""
    return f"{count} {one if count == 1 else several or one + 's'}"


def hint(word: str, known: Iterable[str], listed: str | None = None) -> str:
    """Suggest the known word that was probably meant; else list all, or say where they are listed."""
    words = sorted(known)
    close = difflib.get_close_matches(word[:_LONGEST], words, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    return f"choose from {', '.join(words)}" if listed is None else listed
