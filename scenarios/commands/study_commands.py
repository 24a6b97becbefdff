"""Commands that follow the sources and train models: `datasets`, `reproduce`, `tune`, `train`."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import (
    PATH,
    FieldsCommand,
    GivenOptions,
    films_option,
    options_of,
    workers_options,
)

if TYPE_CHECKING:
    from peopleboy.scenarios.running.engine.task import Workers
    from peopleboy.studies.reproductions.runner import ReproduceOptions
    from peopleboy.studies.reproductions.tune import TrainingFilms


@click.command()
@click.argument("suites", nargs=-1)
@films_option
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


@click.command(cls=FieldsCommand)
@click.argument("names", metavar="[ID]...", nargs=-1)
@options_of("studies.reproductions.runner:ReproduceOptions", "paper", "quick", "repeats", "out", "so_far")
@films_option
@workers_options
@click.option("--list", "lists", is_flag=True, help="List tables and figures, and do nothing.")
def reproduce(
    names: Sequence[str], given: GivenOptions[ReproduceOptions], films: Path, workers: Workers, lists: bool
) -> None:
    """Measure every table and figure of the sources again, print them, and write one page about it.

    ID is one of `--list`, or its number: 4.9 stands for figures 4.9a and 4.9b. A killed call goes on where it
    was when it is given again.
    """
    from peopleboy.studies.reproductions.runner import list_experiments, reproduce_named

    options = given.make(films=films)
    if lists:
        list_experiments(names, options.paper)
    else:
        click.echo(reproduce_named(names, options, workers))


@click.command(cls=FieldsCommand)
@click.option(
    "--parameter",
    "names",
    multiple=True,
    help="alpha, kappa, theta, U, B, psi_D, rho, lambda, n_k or rho_o; several by giving it again.  "
    "[default: all]",
)
@options_of("studies.reproductions.tune:TrainingFilms", "seeds", "seconds")
@click.option(
    "--out",
    type=PATH,
    default=Path("runs/tune"),
    show_default=True,
    help="Folder of the page, the curves and the results.",
)
@films_option
@workers_options
def tune(
    names: Sequence[str], given: GivenOptions[TrainingFilms], out: Path, films: Path, workers: Workers
) -> None:
    """Try other values of the thesis's parameters, one parameter at a time, by area accuracy.

    As in its sections 4.4 to 7.5, each with the tracker of its chapter. Films have seeds from 100 on, which
    no figure is reported on. Leaves a curve of each parameter and a page. A killed call goes on where it was.
    """
    from peopleboy.studies.reproductions.tune import chosen_parameters, print_tuned
    from peopleboy.studies.reproductions.tune import tune as tune_all

    shown = given.make(cache=films.resolve())
    page, tuned = tune_all(chosen_parameters(names), shown, out, workers)
    print_tuned(tuned)
    click.echo(page)


class _Models(click.Group):
    """One subcommand a model; a model's modules are imported when its own options are asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        """Name the models."""
        from peopleboy.studies.training.specification import MODELS

        return list(MODELS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:  # noqa: ARG002
        """Make the command of a model."""
        from peopleboy.studies.training.specification import MODELS, load_specification

        if cmd_name not in MODELS:
            raise BadInput(f"train: unknown model {cmd_name!r}; there are {', '.join(MODELS)}")
        return _command(cmd_name, *MODELS[cmd_name], load_specification(cmd_name))

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """List the models without importing them."""
        from peopleboy.studies.training.specification import MODELS

        with formatter.section("Models"):
            formatter.write_dl([(model, help_text) for model, (_, help_text) in MODELS.items()])


@click.command(cls=_Models, subcommand_metavar="MODEL [OPTIONS]")
def train() -> None:
    """Train one of the models that the trackers use, on rendered sequences.

    Samples and weights are left in a folder; a killed call resumes. Needs pip install 'peopleboy[studies]'.
    """


def _command(model: str, target: str, help_text: str, specification: type[Any]) -> click.Command:
    """Make the command that trains a model."""

    @options_of(f"studies.training.{target}", *(each.name for each in fields(specification)))
    @click.option(
        "--out", type=PATH, help="Folder of samples and weights.  [default: one of the model's in runs]"
    )
    @click.option("--ship", is_flag=True, help="Put the weights in the place of the trackers' own.")
    @workers_options
    def train_model(given: GivenOptions[Any], out: Path | None, ship: bool, workers: Workers) -> None:
        from peopleboy.studies.training.specification import train

        chosen = given.make()
        paths = train(chosen, out or chosen.default_folder(model), workers, ship=ship)
        if specification.HINT:
            click.echo(specification.HINT)
        for path in paths:
            click.echo(path)

    about = f"{help_text}\n\n{inspect.cleandoc(specification.__doc__ or '')}"
    return click.command(model, cls=FieldsCommand, help=about, short_help=help_text)(train_model)
