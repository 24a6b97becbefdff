"""The command `train-places`."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.scenarios.commands.options import workers_options


@click.command("train-places")
@click.option(
    "--scenes", type=click.IntRange(min=2), default=400, show_default=True, help="How many to learn from."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs/places"),
    show_default=True,
    help="Folder for the examples and the networks.",
)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs/foreground/films"),
    show_default=True,
    help="Folder of the films, which train-foreground uses, too.",
)
@click.option("--ship", is_flag=True, help="Put the networks in the place of the tracker's own.")
@workers_options
def train_places(
    scenes: int, out: Path, films: Path, ship: bool, workers: int | None, scheduler: str | None
) -> None:
    """Learn from scenes drawn at random how people look in the panorama from where they stand.

    It is for the tracker `panoramic`, after `train-foreground`, whose network must be there. Needs
    scikit-learn: .[train]. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.workers import chosen_workers
    from peopleboy.scenarios.studies.place_learning.place_lesson import give_place_lesson

    click.echo(give_place_lesson(out, films, chosen_workers(workers, scheduler), scenes=scenes, ship=ship))
