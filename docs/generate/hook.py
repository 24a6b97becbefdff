"""Puts the generated parts into the pages when MkDocs reads them."""

from __future__ import annotations

from typing import Any

from docs.generate.parts import fill_in


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Replace every `<!-- generated: NAME -->` of a page."""
    return fill_in(markdown)
