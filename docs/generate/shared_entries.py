"""Extension for docstring entries with several names, such as `x, y: centre of the ellipse`."""

from __future__ import annotations

import re
from typing import Any

import griffe

_ENTRY = re.compile(r"^( +)(\w+(?:, \w+)+)(: .*(?:\n\1 +.*)*)", re.MULTILINE)


class SharedEntries(griffe.Extension):
    """Split docstring entries with several names into one entry per name."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Rewrite the docstring of an object."""
        if obj.docstring is not None:
            obj.docstring.value = split(obj.docstring.value)


def split(docstring: str) -> str:
    """Repeat an entry for each of its names."""
    return _ENTRY.sub(
        lambda entry: "\n".join(f"{entry[1]}{name}{entry[3]}" for name in entry[2].split(", ")), docstring
    )
