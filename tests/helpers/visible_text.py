"""What a reader sees of a page, as text."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

HIDDEN = ("style", "title", "script")


class _Visible(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []
        self._inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in HIDDEN:
            self._inside.append(tag)
        self.lines += [f"[{value}]" for name, value in attrs if name == "alt"]

    def handle_endtag(self, tag: str) -> None:
        if tag in HIDDEN:
            self._inside.pop()

    def handle_data(self, data: str) -> None:
        if not self._inside and data.strip():
            self.lines.append(" ".join(data.split()))


def visible_text(page: Path) -> str:
    """Give the words of a page, and what its pictures say to those who cannot see them, a line each."""
    reader = _Visible()
    reader.feed(page.read_text(encoding="utf-8"))
    return "\n".join(reader.lines) + "\n"


def assert_reads_as(page: Path, snapshot: Path) -> None:
    """Check that a page's words are those that were kept; the new ones lie beside the page."""
    found = page.with_suffix(".txt")
    found.write_text(visible_text(page), encoding="utf-8")
    kept = snapshot.read_text(encoding="utf-8") if snapshot.is_file() else ""
    assert found.read_text(encoding="utf-8") == kept, f"if it is right so: cp {found} {snapshot}"
