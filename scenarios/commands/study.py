"""Commands that follow the sources: `datasets`, `train-occlusion`, `train-distance`, `reproduce`, `tune`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.completion import complete_scenario
from peopleboy.scenarios.commands.options import Number, WholeNumber, workers_options


@click.command()
@click.argument("suites", nargs=-1)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs/films"),
    show_default=True,
    help="Where rendered frames are kept; for a cluster, a folder that all share.",
)
def datasets(suites: Sequence[str], films: Path) -> None:
    """Count what the data sets hold, beside table 3.1 of the thesis; their frames are rendered and kept.

    SUITES are any of dataset1 to dataset4; without a name, all of them.
    """
    from peopleboy.scenarios.scores.suite_table import THESIS
    from peopleboy.studies.reproductions.runner import print_contents

    for name in suites:
        if name not in THESIS:
            raise BadInput(f"datasets: unknown data set {name!r}; there are {', '.join(THESIS)}")
    print_contents(suites or tuple(THESIS), films)


@click.command("train-occlusion")
@click.option("--tracker", default="contour", show_default=True, help="Whom to teach: contour or thesis.")
@click.option(
    "--seeds",
    type=WholeNumber(min=1),
    default=5,
    show_default=True,
    help="Runs of each scenario.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for the examples and the learned table.  [default: runs/occlusion-TRACKER]",
)
@click.option("--again", is_flag=True, help="Run the scenarios even if the examples are there.")
@click.option("--triplets/--no-triplets", default=True, help="Try weighted triplets as well (a minute).")
@click.option("--ship", is_flag=True, help="Put the learned table in the place of the tracker's own.")
@workers_options
def train_occlusion(
    tracker: str,
    seeds: int,
    out: Path | None,
    again: bool,
    triplets: bool,
    ship: bool,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Learn from scenarios which of two overlapping people is in front, and compare with the thesis.

    Examples are split at random, as there, and scenario by scenario; the table is learned from all of them.
    Needs scikit-learn. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.occlusion_learning.occlusion_lesson import give_lesson

    who = chosen_workers(workers, scheduler)
    folder = out if out is not None else Path("runs") / f"occlusion-{tracker}"
    click.echo(give_lesson(folder, tracker, seeds, who, triplets=triplets, again=again, ship=ship))


@click.command("train-distance")
@click.argument("scenario", default="room_long", shell_complete=complete_scenario)
@click.option("--seeds", type=WholeNumber(min=1), default=10, show_default=True, help="Runs of it.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for the examples and the network.  [default: runs/distance-SCENARIO]",
)
@click.option(
    "--epochs",
    type=WholeNumber(min=1),
    default=2000,
    show_default=True,
    help="How often the network goes through its examples.",
)
@click.option(
    "--ship",
    is_flag=True,
    help="Put the network among the tracker's own, in place of that for the same mirror.",
)
@workers_options
def train_distance(
    scenario: str,
    seeds: int,
    out: Path | None,
    epochs: int,
    ship: bool,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Learn from a scenario how far away a person in the panorama is, for the tracker of the 2003 paper.

    SCENARIO is a name or a path, room_long if left out. It begins with five empty panoramas, and one person
    at a time is there later. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.training.distance_learning.distance_lesson import give_distance_lesson
    from peopleboy.tracker.panoramic.paper.distance_network import Lessons

    who = chosen_workers(workers, scheduler)
    folder = out if out is not None else Path("runs") / f"distance-{Path(scenario).stem}"
    lessons = Lessons(epochs=epochs)
    learned = give_distance_lesson(folder, scenario, seeds, who, lessons=lessons, ships=ship)
    click.echo(learned.summary)
    click.echo("`peopleboy reproduce --paper panoramic` measures it beside the paper")
    click.echo(learned.path)


@click.command()
@click.argument("names", metavar="[ID]...", nargs=-1)
@click.option(
    "--paper",
    help="Only what is of one source: thesis, of 2007; 2005, its evaluation; panoramic, of 2003; situation, "
    "a thesis on depth and colour.",
)
@click.option("--quick", is_flag=True, help="A little of everything, in minutes; the page says of what.")
@click.option(
    "--repeats",
    type=WholeNumber(min=1),
    help="How many random streams, or seeds, everything is repeated with; a later call with more uses "
    "what is there.  [default: 10, as in the sources]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder of the page and the results.  [default: runs/reproduce, or runs/reproduce-quick]",
)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs") / "films",
    show_default=True,
    help="Where rendered frames are kept; for a cluster, a folder that all share.",
)
@workers_options
@click.option("--list", "lists", is_flag=True, help="List tables and figures, and do nothing.")
@click.option(
    "--so-far",
    is_flag=True,
    help="Do no work: write the page of what the folder has, each part with as many repeats as it has.",
)
def reproduce(
    names: Sequence[str],
    paper: str | None,
    quick: bool,
    repeats: int | None,
    out: Path | None,
    films: Path,
    workers: int | None,
    scheduler: str | None,
    lists: bool,
    so_far: bool,
) -> None:
    """Measure every table and figure of the sources again, print them, and write one page about it.

    ID is one of `--list`, or its number: 4.9 stands for figures 4.9a and 4.9b. A killed call goes on where it
    was when it is given again.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.reproductions.plan import REPEATS
    from peopleboy.studies.reproductions.runner import list_experiments, reproduce_named

    if quick and repeats is not None:
        raise BadInput("reproduce: --quick has its own number of repeats; give either it or --repeats")
    if lists:
        list_experiments(names, paper)
    else:
        amount = None if quick else repeats or REPEATS
        folder = out if out is not None else Path("runs") / ("reproduce-quick" if quick else "reproduce")
        who = chosen_workers(workers, scheduler)
        page = reproduce_named(names, paper, folder, films, who, repeats=amount, works=not so_far)
        click.echo(page)


@click.command()
@click.option(
    "--parameter",
    "names",
    multiple=True,
    help="alpha, kappa, theta, U, B, psi_D, rho, lambda, n_k or rho_o; several by giving it again.  "
    "[default: all]",
)
@click.option(
    "--seeds", type=WholeNumber(min=1), default=4, show_default=True, help="Films of each scenario."
)
@click.option(
    "--seconds",
    type=Number(min=5.0),
    default=45.0,
    show_default=True,
    help="How long a film is at most.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("runs") / "tune",
    show_default=True,
    help="Folder of the page, the curves and the results.",
)
@click.option(
    "--films",
    type=click.Path(path_type=Path),
    default=Path("runs") / "films",
    show_default=True,
    help="Where rendered frames are kept; for a cluster, a folder that all share.",
)
@workers_options
def tune(
    names: Sequence[str],
    seeds: int,
    seconds: float,
    out: Path,
    films: Path,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Try other values of the thesis's parameters, one parameter at a time, by area accuracy.

    As in its sections 4.4 to 7.5, each with the tracker of its chapter. Films have seeds from 100 on, which
    no figure is reported on. Leaves a curve of each parameter and a page. A killed call goes on where it was.
    """
    from peopleboy.scenarios.running.engine.task import chosen_workers
    from peopleboy.studies.reproductions.tune import TrainingFilms, print_tuned
    from peopleboy.studies.reproductions.tune import tune as tune_all
    from peopleboy.studies.reproductions.tuned_parameters import chosen_parameters

    shown = TrainingFilms(cache=films.resolve(), seeds=seeds, seconds=seconds)
    page, tuned = tune_all(chosen_parameters(names), shown, out, chosen_workers(workers, scheduler))
    print_tuned(tuned)
    click.echo(page)
