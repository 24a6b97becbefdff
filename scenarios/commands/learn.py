"""Commands that learn from scenes drawn at random, such as `train-foreground`."""

from __future__ import annotations

from pathlib import Path

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.options import WholeNumber, workers_options


@click.command("train-foreground")
@click.option(
    "--scenes", type=WholeNumber(min=1), default=400, show_default=True, help="How many to learn from."
)
@click.option(
    "--tests", type=WholeNumber(min=0), default=20, show_default=True, help="How many others to judge by."
)
@click.option(
    "--rounds",
    type=WholeNumber(min=1),
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
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.foreground_learning.foreground_lesson import (
        ForegroundLessons,
        give_foreground_lesson,
    )

    lessons = ForegroundLessons(scenes=scenes, tests=tests, rounds=rounds)
    click.echo(give_foreground_lesson(out, chosen_workers(workers, scheduler), lessons, ship=ship))


@click.command("train-places")
@click.option(
    "--scenes", type=WholeNumber(min=2), default=400, show_default=True, help="How many to learn from."
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
    scikit-learn. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.place_learning.place_lesson import give_place_lesson

    click.echo(give_place_lesson(out, films, chosen_workers(workers, scheduler), scenes=scenes, ship=ship))


@click.command("train-windows")
@click.option(
    "--scenes", type=WholeNumber(min=1), default=300, show_default=True, help="How many to learn from."
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
    farther, by colour alone and with depth. Needs scikit-learn. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.window_learning.window_lesson import give_window_lesson

    for path in give_window_lesson(out, chosen_workers(workers, scheduler), scenes=scenes, ship=ship):
        click.echo(path)


@click.command("train-detector")
@click.option(
    "--worlds",
    type=WholeNumber(min=5, max=2000),
    default=600,
    show_default=True,
    help="How many to learn from.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs/people"),
    show_default=True,
    help="Folder for the films and the detector.",
)
@click.option("--ship", is_flag=True, help="Put the detector in the place of the tracker's own.")
@click.option(
    "--windows",
    multiple=True,
    type=click.Choice(["whole", "cut"]),
    default=("whole", "cut"),
    show_default=True,
    help="Teach trees for people who are mostly in the image, or cut off; the others stay as they are.",
)
@click.option(
    "--only-places",
    is_flag=True,
    help="Teach where in windows people are; trees that tell whether anybody is there stay as they are.",
)
@click.option(
    "--second-look",
    is_flag=True,
    help="Teach the network that looks again at what trees propose; all else stays as it is.",
)
@click.option(
    "--closer-look",
    is_flag=True,
    help="Teach the network that tells where exactly those are who were found; all else stays as it is.",
)
@workers_options
def train_detector(
    worlds: int,
    out: Path,
    ship: bool,
    windows: tuple[str, ...],
    only_places: bool,
    second_look: bool,
    closer_look: bool,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Learn what people look like to a thermal camera, from random worlds.

    Some are as drawn, others full of people, plain, both, or warm. A tenth is held back, to make scores log
    odds and to tell how good looks are; how good trees are, random worlds of seeds 0 to 29 tell. Needs
    scikit-learn, and for both looks JAX and Optax: pip install '.[train]'. Films that are there are not made
    again.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.look_learning.closer_look_lesson import give_closer_look_lesson
    from peopleboy.studies.training.look_learning.second_look_lesson import give_second_look_lesson
    from peopleboy.studies.training.people_learning.people_lesson import give_people_lesson
    from peopleboy.tracker.proposals.window import Kind

    chosen, kinds = chosen_workers(workers, scheduler), [kind for kind in Kind if kind in windows]
    looks = {"--second-look": second_look, "--closer-look": closer_look}
    asked = [flag for flag, is_asked in looks.items() if is_asked]
    if len(asked) > 1:
        raise BadInput("train-detector: --second-look and --closer-look are two lessons; choose one")
    if asked and (only_places or len(kinds) < len(Kind)):
        raise BadInput(f"train-detector: {asked[0]} teaches no trees; leave out --windows and --only-places")
    if asked:
        lesson = give_second_look_lesson if second_look else give_closer_look_lesson
        click.echo(lesson(out, chosen, worlds=worlds, ship=ship))
        return
    click.echo(
        give_people_lesson(out, chosen, worlds=worlds, kinds=kinds, only_places=only_places, ship=ship)
    )
