"""MkDocs hook that checks the built site."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError

from docs.generate.offline import loads


def on_post_build(config: MkDocsConfig) -> None:
    """Check that the site works without a network.

    Raises:
        PluginError: a page or a style sheet loads a resource from a network.
    """
    for path in sorted(Path(config.site_dir).rglob("*")):
        if path.suffix in (".html", ".css"):
            found = loads(path.read_text(encoding="utf-8"))
            if found:
                raise PluginError(f"{path}: loads {found[0]} from a network; put it into docs/theme")
