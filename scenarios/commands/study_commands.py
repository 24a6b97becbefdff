"""Commands for research: `datasets`, `reproduce`, `tune`, `train`, `export-onnx`."""

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
    Output,
    frame_cache_option,
    options_of,
    output_options,
    seeds_options,
    workers_options,
)

if TYPE_CHECKING:
    from peopleboy.scenarios.running.engine.task import Workers
    from peopleboy.studies.reproductions.runner import ReproduceOptions
    from peopleboy.studies.reproductions.tune import TrainingFilms


@click.command(cls=FieldsCommand)
@click.argument("suites", metavar="[SUITE...]", nargs=-1)
@frame_cache_option
@output_options
def datasets(suites: Sequence[str], frame_cache: Path, output: Output) -> None:
    """Count frames and people in the data sets of the thesis.

    SUITE is one of dataset1 to dataset4; the default is all of them. The counts are printed next to those in
    table 3.1 of the thesis. Rendered frames are cached.
    """
    from peopleboy.scenarios.scores.suite_table import THESIS
    from peopleboy.studies.reproductions.runner import contents_of, contents_to_json, print_contents

    for name in suites:
        if name not in THESIS:
            raise BadInput(f"datasets: unknown data set {name!r}; choose from {', '.join(THESIS)}")
    rows = contents_of(suites or tuple(THESIS), frame_cache)
    output.results(lambda: contents_to_json(rows), lambda: print_contents(rows))


@click.command(cls=FieldsCommand)
@click.argument("names", metavar="[ID]...", nargs=-1)
@options_of(
    "studies.reproductions.runner:ReproduceOptions",
    "paper",
    "quick",
    "seeds",
    "out",
    "label_noise_px",
    "so_far",
)
@frame_cache_option
@workers_options
@click.option("--list", "lists", is_flag=True, help="List the tables and figures without reproducing them.")
@output_options
def reproduce(
    names: Sequence[str],
    given: "GivenOptions[ReproduceOptions]",
    frame_cache: Path,
    workers: "Workers",
    lists: bool,
    output: Output,
) -> None:
    """Reproduce tables and figures of the publications.

    The command prints its results next to the published values, and writes a page about them. ID is an entry
    of `--list` or just its number; for example, 4.9 selects figures 4.9a and 4.9b. If the command is
    interrupted, run it again to resume.
    """
    from peopleboy.studies.reproductions.catalogue import choose
    from peopleboy.studies.reproductions.runner import (
        print_experiments,
        print_sections,
        reproduce_named,
    )

    options = given.make(films=frame_cache)
    if lists:
        chosen = choose(names, options.paper)
        listed = [{"id": one.id, "source": one.source, "title": one.title} for one in chosen]
        output.results(lambda: listed, lambda: print_experiments(chosen))
        return
    page, sections = reproduce_named(names, options, workers)
    if output.is_text:
        print_sections(sections)
    output.lines({"page": page, "sections": [one.id for one in sections]}, page)


@click.command(cls=FieldsCommand)
@click.option(
    "--parameter",
    "names",
    multiple=True,
    help="Parameter to tune: alpha, kappa, theta, U, B, psi_D, rho, lambda, n_k or rho_o. Can be "
    "given several times.  [default: all]",
)
@seeds_options(4, first=100)
@options_of("studies.reproductions.tune:TrainingFilms", "seconds")
@click.option(
    "--out",
    type=PATH,
    default=Path("runs/tune"),
    show_default=True,
    help="Folder for the page, the curves and the results.",
)
@frame_cache_option
@workers_options
@output_options
def tune(
    names: Sequence[str],
    given: "GivenOptions[TrainingFilms]",
    seeds: range,
    out: Path,
    frame_cache: Path,
    workers: "Workers",
    output: Output,
) -> None:
    """Tune the parameters of the thesis trackers, one at a time.

    Each parameter is varied as in sections 4.4 to 7.5 of the thesis, using the tracker of that chapter, and
    scored by area accuracy. Seeds from 100 upwards are used for tuning only, never for reported scores. The
    command writes a curve for each parameter, and a page. If it is interrupted, run it again to resume.
    """
    from peopleboy.studies.reproductions.tune import chosen_parameters, print_tuned
    from peopleboy.studies.reproductions.tune import tune as tune_all

    shown = given.make(cache=frame_cache.resolve(), seeds=seeds)
    page, tuned = tune_all(chosen_parameters(names), shown, out, workers)
    if output.is_text:
        print_tuned(tuned)
    best = {one.parameter.name: {"published": one.parameter.printed, "best": one.best} for one in tuned}
    output.lines({"page": page, "parameters": best}, page)


class _Models(click.Group):
    """A subcommand for each model; a model's modules are imported when its options are needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        """List the names of the models."""
        from peopleboy.studies.training.specification import MODELS

        return list(MODELS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:  # noqa: ARG002
        """Make the command of a model."""
        from peopleboy.studies.training.specification import MODELS, load_specification

        if cmd_name not in MODELS:
            raise BadInput(f"train: unknown model {cmd_name!r}; choose from {', '.join(MODELS)}")
        return _command(cmd_name, *MODELS[cmd_name], load_specification(cmd_name))

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """List the models without importing them."""
        from peopleboy.studies.training.specification import MODELS

        with formatter.section("Models"):
            formatter.write_dl([(model, help_text) for model, (_, help_text) in MODELS.items()])


@click.command(cls=_Models, subcommand_metavar="MODEL [OPTIONS]")
def train() -> None:
    """Train a model for the trackers on rendered sequences.

    The command writes samples and weights to a folder. If training is interrupted, run the command again to
    resume it. Training needs the extra studies: pip install 'peopleboy[studies]'.
    """


def _command(model: str, target: str, help_text: str, specification: type[Any]) -> click.Command:
    """Make the command that trains a model."""

    @options_of(f"studies.training.{target}", *(each.name for each in fields(specification)))
    @click.option("--out", type=PATH, help="Folder for samples and weights.  [default: runs/MODEL]")
    @click.option("--ship", is_flag=True, help="Replace the shipped weights that the trackers use.")
    @workers_options
    @output_options
    def train_model(
        given: GivenOptions[Any], out: Path | None, ship: bool, workers: "Workers", output: Output
    ) -> None:
        from peopleboy.studies.training.specification import train

        chosen = given.make()
        paths = train(chosen, out or chosen.default_folder(model), workers, ship=ship)
        hints = [specification.HINT] if specification.HINT else []
        output.lines({"weights": [str(path) for path in paths], "hints": hints}, *hints, *paths)

    about = f"{help_text}\n\n{inspect.cleandoc(specification.__doc__ or '')}"
    return click.command(model, cls=FieldsCommand, help=about, short_help=help_text)(train_model)


@click.command("export-onnx", cls=FieldsCommand)
@click.argument("networks", metavar="[NETWORK...]", nargs=-1)
@click.option(
    "--out",
    type=PATH,
    default=Path("onnx"),
    show_default=True,
    help="Folder for the models and the model card.",
)
@output_options
def export_onnx(networks: tuple[str, ...], out: Path, output: Output) -> None:
    """Export the trackers' networks to ONNX, with a model card.

    NETWORK is rescoring, box-refinement, places, foreground, distance-room_long or distance-room_narrow; the
    default is all of them. The command needs the extra onnx: pip install 'peopleboy[onnx]'.
    """
    from peopleboy.studies.training.export_onnx import export_onnx as write

    paths = [str(path) for path in write(networks, out)]
    output.lines({"files": paths}, *paths)
