"""The command `peopleboy train MODEL`, whose options come from the model's specification."""

from __future__ import annotations

import inspect
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, get_type_hints

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.command_options import WholeNumber, workers_options


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
