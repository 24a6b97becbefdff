"""The curves: a picture of each parameter, a page of all, and a table on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from html import escape
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

from peopleboy.studies.reproductions.showing.source_page import span
from peopleboy.studies.reproductions.tuning.tuned import CRITERION, Tuned

PAGE = "index.html"
_COLUMNS = ("parameter", "thesis", "printed", "best here", f"{CRITERION}, best less printed (95 %)", "")
_HEAD = """<!doctype html>
<html lang="en-GB"><head><meta charset="utf-8"><title>PeopleBoy: parameters of the thesis, tuned</title>
<style>
body { margin: 2rem auto; max-width: 60rem; padding: 0 1rem; font: 16px/1.5 system-ui, sans-serif; }
table { border-collapse: collapse; font-size: .875rem; } th, td { padding: .25rem .6rem; text-align: left; }
tr { border-bottom: 1px solid #d9dee5; } img { width: 100%; }
figure { display: inline-block; width: 28rem; max-width: 100%; margin: .5rem 0; }
</style></head><body>
<h1>The parameters of the thesis, one at a time</h1>
"""
_ABOUT = (
    "All else is as printed. Dots are means over the films, bars the standard deviations; the line down is "
    "the printed value. Differences have their 95 % interval over the films, and Cohen's h."
)


def write_tuned_page(out: Path, tuned: Sequence[Tuned], films: str) -> Path:
    """Write NAME.svg for each parameter and a page that shows them."""
    for one in tuned:
        _save(_curve(one), out / f"{one.parameter.name}.svg")
    rows = "".join(_html_row("td", _cells(one)) for one in tuned)
    pictures = "".join(
        f'<figure><img src="{one.parameter.name}.svg" alt="{CRITERION} over {escape(one.parameter.name)}">'
        f"</figure>\n"
        for one in tuned
    )
    page = out / PAGE
    page.write_text(
        f"{_HEAD}<p>{escape(films)} {_ABOUT}</p>\n<table>\n{_html_row('th', _COLUMNS)}{rows}</table>\n"
        f"{pictures}</body></html>\n",
        encoding="utf-8",
    )
    return page


def print_tuned(tuned: Sequence[Tuned]) -> None:
    """Print the printed value of each parameter, the best one, and how sure that is."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in _COLUMNS:
        table.add_column(name)
    for one in tuned:
        table.add_row(*_cells(one))
    Console(width=None if sys.stdout.isatty() else 140, highlight=False).print(table)


def _cells(one: Tuned) -> tuple[str, ...]:
    parameter = one.parameter
    gain = span(one.gain, CRITERION) if one.best != parameter.printed else "-"
    return (parameter.name, parameter.section, parameter.printed, one.best, gain, one.verdict)


def _html_row(cell: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{cell}>{escape(text)}</{cell}>" for text in cells) + "</tr>\n"


def _curve(one: Tuned) -> Figure:
    """Draw area accuracy over the values, which are at equal distances."""
    figure = Figure(figsize=(4.5, 2.8), layout="constrained")
    FigureCanvasSVG(figure)
    axes = figure.add_subplot()
    values = list(one.accuracy)
    means = [figures.mean() for figures in one.accuracy.values()]
    spreads = [figures.std(ddof=1) if figures.size > 1 else 0.0 for figures in one.accuracy.values()]
    axes.axvline(values.index(one.parameter.printed), color="#999999", linestyle="--", linewidth=1)
    axes.errorbar(np.arange(len(values)), means, spreads, color="#d95f02", marker="o", capsize=3)
    axes.set_xticks(range(len(values)), values)
    axes.set_xlabel(f"{one.parameter.name}: {one.parameter.says}", fontsize=8)
    axes.set_ylabel(f"{CRITERION} [%]", fontsize=8)
    axes.set_ylim(bottom=0.0)
    axes.tick_params(labelsize=8)
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def _save(figure: Figure, path: Path) -> None:
    # Neither date nor creator, and ids by name: the same figures give the same bytes.
    with matplotlib.rc_context({"svg.hashsalt": path.stem}):
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
