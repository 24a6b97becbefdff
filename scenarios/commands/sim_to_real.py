"""The command `sim-to-real`: rendered thermal pictures beside real ones."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.scenarios.commands.command_options import WholeNumber


@click.command("sim-to-real")
@click.argument("rendered", metavar="RENDERED...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--real",
    metavar="FOLDER",
    multiple=True,
    required=True,
    type=click.Path(path_type=Path),
    help="A real clip, or a folder of some; can be given again.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("comparison.html"),
    show_default=True,
    help="The page.",
)
@click.option("--json", "as_json", is_flag=True, help="Print all figures as JSON.")
@click.option("--seed", type=WholeNumber(min=0), default=0, show_default=True, help="Of what is chosen.")
def sim_to_real(rendered: Sequence[Path], real: Sequence[Path], out: Path, as_json: bool, seed: int) -> None:
    """Set rendered thermal pictures beside real ones, and say how well a classifier separates them.

    RENDERED are folders of runs with pictures, or sets of them. A real clip is a folder with pictures in it
    or in thermal/, 8-bit grey, and gt.txt of the MOTChallenge format, or VOT's or OTB's. Both sides need two
    scenes at least. Needs scikit-learn.
    """
    from peopleboy.scenarios.report.page_file import check_place
    from peopleboy.scenarios.sim_to_real.compare import compare_images as compare
    from peopleboy.scenarios.sim_to_real.page import HEADS, headline, table_rows, write_comparison

    check_place(out)
    found = compare(rendered, real, seed)
    write_comparison(found, out)
    if as_json:
        click.echo(json.dumps(found.to_json(), indent=2))
        return
    for name, side in (("rendered", found.rendered), ("real", found.real)):
        for row in table_rows(name, side)[:1]:
            click.echo(f"{name}: " + ", ".join(f"{h} {v}" for h, v in zip(HEADS[1:], row[1:], strict=True)))
    click.echo(headline(found))
    if found.lacking:
        click.echo(f"{found.lacking}.")
    click.echo(out)
