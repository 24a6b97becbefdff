"""Write a table of metrics as text for other programs: CSV, LaTeX and Markdown."""

import csv
import io
import math
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from peopleboy.scenarios.scores.bootstrap import LEVEL, PairedDifference
from peopleboy.scenarios.scores.summaries import Summary
from peopleboy.scenarios.scores.tables.score_table import ScoreTable, TableRow
from peopleboy.tracker.evaluation.table import Figure

_CSV_COLUMNS: Final = (
    *("part", "tracker", "compared_with", "metric", "unit", "runs"),
    *("all_frames", "mean", "sd", "ci_low", "ci_high", "p"),
)
_SMALLEST_P: Final = 0.001


class Signs(NamedTuple):
    """Signs of a format."""

    plus_minus: str
    minus: str
    less: str
    percent: str
    up: str
    down: str
    bold: str  # a format of the text


_PLAIN: Final = Signs("±", "-", "<", "%", "↑", "↓", "{}")
_MARKDOWN: Final = _PLAIN._replace(bold="**{}**")
_LATEX: Final = Signs(r"$\pm$", "$-$", "$<$", r"\%", r"$\uparrow$", r"$\downarrow$", r"\textbf{{{}}}")


def to_csv(table: ScoreTable) -> str:
    """Return one line for each row and metric, with all digits; undefined values are empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_CSV_COLUMNS)
    for row in table.rows:
        for figure, cell in zip(table.figures, row.cells, strict=True):
            about = (row.part, row.tracker, row.other, figure.name, figure.unit, row.runs)
            writer.writerow((*about, *("" if math.isnan(value) else value for value in _values(cell))))
    return text.getvalue()


def _values(cell: Summary | PairedDifference) -> tuple[float, ...]:
    """Return value over all frames, mean, deviation, bounds of the interval and p-value; NaN for none."""
    mean, low, high = cell.interval.mean, cell.interval.low, cell.interval.high
    if isinstance(cell, Summary):
        return cell.whole, mean, cell.sd, low, high, math.nan
    return math.nan, mean, math.nan, low, high, cell.p


def to_markdown(table: ScoreTable) -> str:
    """Return a Markdown table, with a caption below; the best mean of a part is bold."""
    heads, rows = table_cells(table, _MARKDOWN)
    lines = [heads, ["---", *["---" if head in ("tracker", _part(table)) else "---:" for head in heads[1:]]]]
    text = "\n".join(f"| {' | '.join(line)} |" for line in [*lines, *rows])
    return f"{text}\n\n{caption(table, _MARKDOWN)}\n"


def to_latex(table: ScoreTable) -> str:
    """Return a LaTeX table for the package booktabs; the best mean of a part is bold."""
    heads, rows = table_cells(table, _LATEX, escape_latex)
    left = 2 if table.per else 1
    lines = [
        r"% \usepackage{booktabs}",
        r"\begin{table}",
        r"  \centering",
        f"  \\caption{{{caption(table, _LATEX)}}}",
        f"  \\begin{{tabular}}{{{'l' * left}{'r' * (len(heads) - left)}}}",
        r"    \toprule",
        f"    {' & '.join(heads)} \\\\",
    ]
    part = None
    for row, cells in zip(table.rows, rows, strict=True):
        lines += [r"    \midrule"] if row.part != part else []
        part = row.part
        lines.append(f"    {' & '.join(cells)} \\\\")
    return "\n".join([*lines, r"    \bottomrule", r"  \end{tabular}", r"\end{table}", ""])


_LATEX_ESCAPES: Final = str.maketrans(
    {
        **{sign: f"\\{sign}" for sign in "&%$#_{}"},
        "\\": r"\textbackslash{}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
    }
)


def escape_latex(text: str) -> str:
    """Escape the signs that have a meaning in LaTeX."""
    return text.translate(_LATEX_ESCAPES)


WRITERS: Final[Mapping[str, Callable[[ScoreTable], str]]] = {
    "csv": to_csv,
    "latex": to_latex,
    "markdown": to_markdown,
}
"""Formats of a table by name."""


def table_cells(
    table: ScoreTable, signs: Signs = _PLAIN, escape: Callable[[str], str] = str
) -> tuple[list[str], list[list[str]]]:
    """Return the headings and the rows of a table as texts."""
    has_parts = table.per is not None
    heads = [*([_part(table)] if has_parts else []), "tracker", "runs"]
    heads += [_head(figure, signs, escape) for figure in table.figures]
    rows = []
    for row in table.rows:
        name = signs.minus.join(map(escape, (f"{row.tracker} ", f" {row.other}"))) if row.other else ""
        cells = [_cell(table, row, column, signs) for column in range(len(table.figures))]
        part = [escape(row.part)] if has_parts else []
        rows.append([*part, name or escape(row.tracker), str(row.runs), *cells])
    return heads, rows


def _part(table: ScoreTable) -> str:
    return "" if table.per is None else table.per.replace("-", " ")


def _head(figure: Figure, signs: Signs, escape: Callable[[str], str]) -> str:
    arrow = {1: signs.up, -1: signs.down, 0: ""}[figure.better]
    unit = f"[{escape(figure.unit)}]" if figure.unit else ""
    return " ".join(part for part in (escape(figure.name), unit, arrow) if part)


def _cell(table: ScoreTable, row: TableRow, column: int, signs: Signs) -> str:
    cell, figure = row.cells[column], table.figures[column]
    if math.isnan(cell.interval.mean):
        return "--" if signs is _LATEX else "-"
    digits = _digits(figure)
    if isinstance(cell, PairedDifference):
        return _difference(cell, digits, signs)
    if cell.runs == 1:
        is_count = not figure.unit and cell.mean == int(cell.mean)
        return _bold(table, row, column, f"{cell.mean:.{0 if is_count else digits}f}", signs)
    low, high = f"{cell.interval.low:.{digits}f}", f"{cell.interval.high:.{digits}f}"
    mean = _bold(table, row, column, f"{cell.mean:.{digits}f}", signs)
    return f"{mean} {signs.plus_minus} {cell.sd:.{digits}f} [{low}, {high}]"


def _bold(table: ScoreTable, row: TableRow, column: int, text: str, signs: Signs) -> str:
    return signs.bold.format(text) if table.best(row, column) else text


def _difference(cell: PairedDifference, digits: int, signs: Signs) -> str:
    values = (cell.interval.mean, cell.interval.low, cell.interval.high)
    mean, low, high = (f"{value:+.{digits}f}".replace("-", signs.minus) for value in values)
    if not cell.interval.is_known:
        return mean
    p = f"p {signs.less} {_SMALLEST_P}" if cell.p < _SMALLEST_P else f"p = {cell.p:.3f}"
    return f"{mean} [{low}, {high}], {p}"


def _digits(figure: Figure) -> int:
    """Return the digits after the point that a table shows of a metric."""
    return {"%": 1, "m": 2, "ms": 1}.get(figure.unit, 3 if figure.group in ("sets", "floor") else 1)


def caption(table: ScoreTable, signs: Signs = _PLAIN) -> str:
    """Return the sentences that explain the cells."""
    single = all(row.runs == 1 for row in table.rows)
    if single:
        return "Values of one run each."
    level = f"{LEVEL:.0%}".replace("%", f" {signs.percent}")
    text = f"Mean {signs.plus_minus} standard deviation over runs [{level} bootstrap interval]."
    if any(row.other for row in table.rows):
        text += (
            f" Differences are over runs of the same scenario and seed, with the {level} bootstrap interval "
            "and the p-value of the Wilcoxon signed-rank test."
        )
    return text
