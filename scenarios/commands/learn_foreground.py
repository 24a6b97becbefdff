"""The command `train-foreground`."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.scenarios.commands.options import workers_options


@click.command("train-foreground")
@click.option(
    "--scenes", type=click.IntRange(min=1), default=400, show_default=True, help="How many to learn from."
)
@click.option(
    "--tests", type=click.IntRange(min=0), default=20, show_default=True, help="How many others to judge by."
)
@click.option(
    "--rounds",
    type=click.IntRange(min=1),
    default=12,
    show_default=True,
    help="How often a hundred of the scenes are learned from.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs") / "foreground",
    show_default=True,
    help="Folder for the films and the network.",
)
@click.option("--ship", is_flag=True, help="Put the network in the place of the tracker's own.")
@workers_options
def train_foreground(
    scenes: int, tests: int, rounds: int, out: Path, ship: bool, workers: int | None, scheduler: str | None
) -> None:
    """Learn to tell people from background in the panorama, from scenes drawn at random.

    Their places, things, people and drives are drawn by their seeds. Films that are there are not made again.
    """
    from peopleboy.scenarios.running.engine.workers import chosen_workers
    from peopleboy.scenarios.studies.foreground_learning.foreground_lesson import (
        ForegroundLessons,
        give_foreground_lesson,
    )

    lessons = ForegroundLessons(scenes=scenes, tests=tests, rounds=rounds)
    click.echo(give_foreground_lesson(out, chosen_workers(workers, scheduler), lessons, ship=ship))
