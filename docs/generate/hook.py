"""Looks at the site when MkDocs has built it."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError

from docs.generate.offline import loads


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
