"""The command `render`: data sets for others to train and test on."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.scenarios.commands.options import TRACKERS, workers_options

FAILED = 1


@click.command()
@click.argument("scenarios", metavar="SCENARIO...", nargs=-1, required=True)
@click.option("--frames", is_flag=True, help="Write every image too, as for `run`; else truth alone.")
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=100,
    show_default=True,
    help="How many, from 0 on; from 7 on every split has runs.",
)
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder of the set.  [default: sets/SCENARIO-SCENARIO...]"
)
@click.option(
    "--tracker",
    default="truth",
    show_default=True,
    help=f"Whose eyes steer robots that follow people: {TRACKERS}.",
)
@workers_options
def render(
    scenarios: Sequence[str],
    frames: bool,
    seeds: int,
    out: Path | None,
    tracker: str,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Render a data set: scenarios with many seeds, split, counted and checked, with a datasheet.

    A killed call goes on where it was; with more --seeds the set grows, and no run changes its split.
    """
    from peopleboy.scenarios.export.dataset.make_dataset import render_set
    from peopleboy.scenarios.files.load import load_scenario
    from peopleboy.scenarios.running.engine.workers import chosen_workers

    who = chosen_workers(workers, scheduler)
    names = [load_scenario(scenario).name for scenario in scenarios]
    folder = out if out is not None else Path("sets") / "-".join(names)
    done = render_set(scenarios, seeds, folder, frames=frames, tracker=tracker, workers=who)
    for check in done.checks:
        click.echo(f"{'holds' if not check.failures else 'FAILS'}: {check.what}")
        for failure in check.failures[:5]:
            click.echo(f"       {failure}")
    content = done.statistics["all"].content
    click.echo(
        f"{len(done.runs)} runs, {content['frames']} frames, {content['detections']} people to detect, "
        f"{done.size_mb:.0f} MB"
    )
    if done.lacking:
        click.echo(done.lacking)
    click.echo(folder / "README.md")
    if not done.is_sound:
        sys.exit(FAILED)
