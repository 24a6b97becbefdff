"""The command `render`: data sets for others to train and test on."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    TRACKERS,
    WholeNumber,
    complete_trackers,
    workers_options,
)
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.wording import counted

FAILED = 1


@click.command()
@click.argument("scenarios", metavar="[SCENARIO...]", nargs=-1, shell_complete=complete_scenario)
@click.option("--frames", is_flag=True, help="Write every image too, as for `run`; else truth alone.")
@click.option(
    "--seeds",
    type=WholeNumber(min=1),
    help="How many, from 0 on; from 7 on every split has runs.  [default: 100]",
)
@click.option(
    "--randomise",
    metavar="N",
    type=WholeNumber(min=1),
    help="In place of scenarios: how many worlds, each drawn at random.",
)
@click.option(
    "--seed",
    type=WholeNumber(min=0),
    help="Of the first random world; the next one has the next.  [default: 0]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the set.  [default: sets/SCENARIO-SCENARIO..., or sets/worlds]",
)
@click.option(
    "--tracker",
    shell_complete=complete_trackers,
    default="truth",
    show_default=True,
    help=f"Whose eyes steer robots that follow people: {TRACKERS}.",
)
@workers_options
def render(
    scenarios: Sequence[str],
    frames: bool,
    seeds: int | None,
    randomise: int | None,
    seed: int | None,
    out: Path | None,
    tracker: str,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Render a data set: scenarios with many seeds, split, counted and checked, with a datasheet.

    Or, with --randomise, worlds of which each has its own place, things, temperatures, people and cameras. A
    killed call goes on where it was; with more --seeds, or worlds, the set grows, and no run changes its
    split.
    """
    from peopleboy.scenarios.export.make_dataset import of_scenarios, of_worlds, render_set
    from peopleboy.scenarios.running.engine.task import chosen_workers

    who = chosen_workers(workers, scheduler)
    if randomise is None:
        if seed is not None or not scenarios:
            raise BadInput("render: give scenarios, or --randomise N, which --seed goes with")
        contents = of_scenarios(scenarios, 100 if seeds is None else seeds)
        usual = "-".join(contents.about["scenarios"])
    else:
        if seeds is not None or scenarios:
            raise BadInput(
                "render: --randomise draws worlds in place of scenarios and --seeds; leave these out"
            )
        contents, usual = of_worlds(randomise, 0 if seed is None else seed), "worlds"
    folder = out if out is not None else Path("sets") / usual
    done = render_set(contents, folder, frames=frames, tracker=tracker, workers=who)
    for check in done.checks:
        click.echo(f"{'holds' if not check.failures else 'FAILS'}: {check.what}")
        for failure in check.failures[:5]:
            click.echo(f"       {failure}")
    content = done.statistics["all"].content
    click.echo(
        f"{counted(len(done.runs), 'run')}, {counted(content['frames'], 'frame')}, "
        f"{counted(content['detections'], 'box', 'boxes')} of people, {done.size_mb:.0f} MB"
    )
    if done.lacking:
        click.echo(done.lacking)
    click.echo(folder / "README.md")
    if not done.is_sound:
        sys.exit(FAILED)
