"""Commands that follow the sources and train models: `datasets`, `reproduce`, `tune`, `train`."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, get_type_hints

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import Number, WholeNumber, workers_options


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
        return _command(cmd_name, MODELS[cmd_name][1], load_specification(cmd_name))

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """List the models without importing them."""
        from peopleboy.studies.training.specification import MODELS

        with formatter.section("Models"):
            formatter.write_dl([(model, help_text) for model, (_, help_text) in MODELS.items()])


@click.command(cls=_Models, subcommand_metavar="MODEL [OPTIONS]")
def train() -> None:
    """Train one of the models that the trackers use, on rendered sequences.

    Samples and weights are left in a folder; a killed call resumes. Needs pip install '.[train]'.
    """


def _command(model: str, help_text: str, specification: type[Any]) -> click.Command:
    """Make the command that trains a model."""

    def run(
        out: Path | None,
        ship: bool,
        workers: int | None,
        scheduler: str | None,
        **values: Any,
    ) -> None:
        from peopleboy.scenarios.running.engine.task import chosen_workers
        from peopleboy.studies.training.specification import train as train_model

        chosen = specification(**values)
        folder = out if out is not None else chosen.default_folder(model)
        paths = train_model(chosen, folder, chosen_workers(workers, scheduler), ship=ship)
        if specification.HINT:
            click.echo(specification.HINT)
        for path in paths:
            click.echo(path)

    about = f"{help_text}\n\n{inspect.cleandoc(specification.__doc__ or '')}"
    command = click.command(model, help=about, short_help=help_text)(workers_options(run))
    command.params = [
        *(_option(each, get_type_hints(specification)[each.name]) for each in fields(specification)),
        click.Option(
            ["--out"],
            type=click.Path(path_type=Path),
            help="Folder of samples and weights.  [default: one of the model's in runs]",
        ),
        click.Option(["--ship"], is_flag=True, help="Put the weights in the place of the trackers' own."),
        *command.params,
    ]
    return command


def _option(field: Any, kind: Any) -> click.Option:
    """Make an option of a field that `option` declared."""
    limits, default = field.metadata, field.default
    assert default is not MISSING
    flag = f"--{field.name.replace('_', '-')}"
    if kind is bool:
        return click.Option([flag], is_flag=True, help=limits["help"])
    types: dict[Any, Any] = {
        int: WholeNumber(min=limits.get("minimum"), max=limits.get("maximum")),
        str: click.STRING,
        Path: click.Path(path_type=Path),
    }
    return click.Option(
        [flag],
        type=click.Choice(limits["choices"]) if "choices" in limits else types[kind],
        default=default,
        multiple=isinstance(default, tuple),
        show_default=True,
        help=limits["help"],
    )
