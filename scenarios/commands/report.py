"""The command `report`: one page about runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click


@click.command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Page to write.  [default: RUN/report.html; report.html here for several]",
)
def report(runs: Sequence[Path], out: Path | None) -> None:
    """Write one HTML page about runs: who was tracked, hidden, lost and swapped, and why.

    Two to four RUNs stand side by side; more are taken together by tracker. A folder that holds folders of
    runs, such as that of a sweep, is taken together too.
    """
    from peopleboy.scenarios.report.report_page import write_report

    page = out if out is not None else (runs[0] / "report.html" if len(runs) == 1 else Path("report.html"))
    for line in write_report(runs, page):
        click.echo(f"peopleboy: {line}", err=True)
    click.echo(page)
