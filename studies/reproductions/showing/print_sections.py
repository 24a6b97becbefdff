"""Tables and figures of the sources beside ours, on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable

from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from peopleboy.studies.reproductions.showing.source_page import Checked, Section, span

_FILE_WIDTH = 160


def print_sections(sections: Iterable[Section]) -> None:
    """Print every section: its table, and how the source's claims fare."""
    console = Console(width=None if sys.stdout.isatty() else _FILE_WIDTH, highlight=False)
    for part in sections:
        console.print(
            f"[bold]{escape(part.id)}[/bold]: {escape(part.table.title)} ({escape(part.table.source)})"
        )
        if part.rows:
            console.print(_table(part))
        if part.compared:
            console.print(_beside(part))
        if part.picture is not None:
            console.print("  a picture is on the page")
        for item in part.checked:
            _print_claim(console, item)
        if part.left_out:
            console.print(f"  left out of this run: {escape(', '.join(part.left_out))}")
        console.print()


def _table(part: Section) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for number, name in enumerate(("", "", *part.columns)):
        table.add_column(Text(name), justify="left" if number < 2 else "right")
    for row in part.rows:
        cells = (row.group if row.is_first else "", row.who, *row.cells)
        table.add_row(*map(Text, cells), style="dim" if row.is_source else "")
    return table


def _beside(part: Section) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("", "", "", "ours less the source's (95 %), effect size", ""):
        table.add_column(name)
    for one in part.compared:
        cells = (one.group, one.column, one.who, span(one.difference, one.column), one.standing.value)
        table.add_row(*map(Text, cells))
    return table


def _print_claim(console: Console, item: Checked) -> None:
    metric = item.claim.metric
    console.print(f"  {escape(item.claim.says)}")
    for one in item.verdicts:
        times = "" if one.times is None else f"{one.times:.2f} times; "
        told = f"{one.outcome.value}; {times}{metric} {span(one.difference, metric)}"
        console.print(f"    {escape(one.who)}: {escape(told)}")
        for test in one.tests:
            console.print(f"      {escape(test)}")
