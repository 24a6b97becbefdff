"""The command `train-windows`."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.scenarios.commands.options import workers_options


@click.command("train-windows")
@click.option(
    "--scenes", type=click.IntRange(min=1), default=300, show_default=True, help="How many to learn from."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs/windows"),
    show_default=True,
    help="Folder for the examples and the machines.",
)
@click.option("--ship", is_flag=True, help="Put the machines in the place of the tracker's own.")
@workers_options
def train_windows(scenes: int, out: Path, ship: bool, workers: int | None, scheduler: str | None) -> None:
    """Learn what people look like to a depth camera, from scenes drawn at random.

    It is for the trackers `rgbd` and `rgbd-printed`: support vector machines for who is near and who is
    farther, by colour alone and with depth. Needs scikit-learn: .[train]. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.workers import chosen_workers
    from peopleboy.scenarios.studies.window_learning.window_lesson import give_window_lesson

    for path in give_window_lesson(out, chosen_workers(workers, scheduler), scenes=scenes, ship=ship):
        click.echo(path)
