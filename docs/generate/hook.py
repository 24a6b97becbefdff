"""Puts the generated parts into the pages when MkDocs reads them, and looks at the site when it is built."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError

from docs.generate.offline import loads
from docs.generate.parts import fill_in


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Replace every `<!-- generated: NAME -->` of a page."""
    return fill_in(markdown)


def on_post_build(config: MkDocsConfig) -> None:
    """Refuse a site that a reader without a network would not see whole.

    Raises:
        PluginError: a page or a style sheet loads something from a network.
    """
    for path in sorted(Path(config.site_dir).rglob("*")):
        if path.suffix in (".html", ".css"):
            found = loads(path.read_text(encoding="utf-8"))
            if found:
                raise PluginError(f"{path}: loads {found[0]} from a network; put it into docs/theme")
