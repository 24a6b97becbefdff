"""Page of a reproduction run, and its overview table for the documentation."""

from __future__ import annotations

from typing import Final

from docs.generate.markdown import table
from docs.generate.sources.source_run import SourceRun
from peopleboy.studies.reproductions.source_page import page_text, section

PAGE: Final = "page.html"
_WHO: Final = ("literal", "default")


def whole_page(run: SourceRun) -> str:
    """Return the page as written by `peopleboy reproduce`, with its pictures in separate files."""
    return page_text([section(one) for one in run.outcomes], run.head)


def overview(run: SourceRun) -> str:
    """Return a table of the outcome of each table and figure, with links to details."""
    rows = [
        (
            f"[{part.id}]({PAGE}#{part.id})",
            part.table.title,
            "" if part.outcome.repeats is None else str(part.outcome.repeats),
            *(part.summary(who) for who in _WHO),
            *(part.standings(who) for who in _WHO),
        )
        for part in map(section, run.outcomes)
    ]
    head = (
        "part",
        "content",
        "repeats",
        *(f"{what}, {who}" for what in ("claims", "values") for who in _WHO),
    )
    facts = table(("property", "value"), [*run.head.lines, ("Amount", run.head.amount)])
    return f"{facts}\n{table(head, rows)}"
