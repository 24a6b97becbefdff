"""`python -m benchmarks.results TABLE...`: take what was measured into the documentation."""

from __future__ import annotations

from collections.abc import Sequence

import click

from benchmarks import call
from benchmarks.results.measured import take_in
from benchmarks.results.tables import PATH, ResultTables, as_yaml, read_tables
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.schema_errors import hint


@click.command()
@click.argument("names", metavar="[TABLE]...", nargs=-1)
def main(names: Sequence[str]) -> None:
    """Take the figures of these tables in from where their commands left them; without a name, list all.

    `make pages` shows them on the page of results.
    """
    known = read_tables().tables
    for name in names:
        if name not in known:
            raise BadInput(f"unknown table {name!r}; {hint(name, known)}")
    if names:
        taken = {name: take_in(known[name]) for name in names}
        PATH.write_text(as_yaml(ResultTables(tables=known | taken)), encoding="utf-8")
    else:
        for name, table in known.items():
            click.echo(f"{name:20s} {table.recorded}  {table.command}")


if __name__ == "__main__":
    call(main, "benchmarks.results")
