"""Code blocks of the documentation's pages, for the tests."""

import re
from dataclasses import dataclass
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"

_BLOCK = re.compile(
    r"(?:<!-- (?P<mark>not run|needs): (?P<about>[^\n]*?) -->\n)?"
    r"```(?P<language>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<code>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class Block:
    """A code block: where it is, what it is written in, the file that it stands for, and what it needs."""

    where: str
    language: str
    title: str
    code: str
    needs: str


def blocks(page: Path) -> list[Block]:
    """List the blocks of a page that a reader would run or save, in order."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            where=f"{page.name}, line {text.count(chr(10), 0, found.start('code')) + 1}",
            language=found["language"],
            title=found["title"] or "",
            code=found["code"],
            needs=found["about"] if found["mark"] == "needs" else "",
        )
        for found in _BLOCK.finditer(text)
        if found["mark"] != "not run" and (found["title"] or found["language"] in ("sh", "python"))
    ]
