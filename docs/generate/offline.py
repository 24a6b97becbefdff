"""Resources that a page or style sheet loads from a network."""

from __future__ import annotations

import re

_SOURCES = re.compile(
    r"""<(?:script|img|iframe|source|video|audio|embed)\b[^>]*?\bsrc=["']?((?:https?:)?//[^"'\s>]+)"""
    r"""|<link\b[^>]*?\bhref=["']?((?:https?:)?//[^"'\s>]+)"""
    r"""|(?:url\(|@import)\s*["']?((?:https?:)?//[^"'\s)]+)"""
)


def loads(text: str) -> list[str]:
    """List the network addresses of scripts, styles, images and frames; hyperlinks are not included."""
    return ["".join(found) for found in _SOURCES.findall(text)]
