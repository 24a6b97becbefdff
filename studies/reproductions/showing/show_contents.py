"""The thesis's table 3.1: its data sets beside ours."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.running.run_suite import films_of
from peopleboy.scenarios.scores.suite_table import THESIS, Content, add_up, count

_RATE_HZ = 15.0


def count_suite(name: str, films: Path) -> Content:
    """Count what a suite holds; frames that are not in the folder yet are rendered."""
    return add_up(count(shot.people(), shot.frames, _RATE_HZ) for shot in films_of(name, films))


def print_contents(names: Sequence[str], films: Path) -> None:
    """Print what data sets hold, each beside the thesis's of the same name."""
    table = Table(title="thesis, table 3.1: ours (theirs)", title_justify="left", box=None, pad_edge=False)
    table.add_column("")
    for name in names:
        table.add_column(name, justify="right")
    ours = [count_suite(name, films) for name in names]
    for field in fields(Content):
        cells = [
            f"{getattr(content, field.name)} ({getattr(THESIS[name], field.name)})"
            for name, content in zip(names, ours, strict=True)
        ]
        table.add_row(field.name.replace("_", " "), *cells)
    (Console() if sys.stdout.isatty() else Console(width=120)).print(table)
