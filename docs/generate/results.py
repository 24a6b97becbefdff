"""Generate the tables of measured results from docs/results.yaml."""

from __future__ import annotations

from benchmarks.results import ResultColumn, ResultTable
from docs.generate.markdown import table


def results(one: ResultTable) -> str:
    """Return a table of results, with how, when and on what they were measured."""
    head = (one.rows_are, *(column.name for column in one.columns))
    rows = [
        (row.name, *(_cell(value, column) for value, column in zip(row.figures, one.columns, strict=True)))
        for row in one.rows
    ]
    return f"{table(head, rows)}\n{_about(one)}"


def _cell(value: float | None, column: ResultColumn) -> str:
    return "" if value is None else column.form.format(value)


def _about(one: ResultTable) -> str:
    measured = f"Measured on {one.recorded} with `{one.command}` on {one.seeds}."
    return f"> {measured} {one.chosen_on}".rstrip()
