"""The command line: `peopleboy`."""

from __future__ import annotations

import errno
import sys
from collections.abc import Sequence
from typing import Any

import click

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed
from peopleboy.scenarios.commands.dataset_commands import export, render
from peopleboy.scenarios.commands.footage_commands import import_tracks, sim_to_real, track
from peopleboy.scenarios.commands.inspect_commands import (
    evaluate,
    list_command,
    report,
    scene_model,
    schema,
    show,
    view,
)
from peopleboy.scenarios.commands.run_commands import compare, run, sweep
from peopleboy.scenarios.commands.study_commands import datasets, reproduce, train, tune
from peopleboy.scenarios.running.engine.task import TasksFailed

FAILED = 1
BAD_INPUT = 2
_FULL = (errno.ENOSPC, errno.EDQUOT)
COMMANDS = (
    list_command,
    show,
    schema,
    run,
    sweep,
    render,
    evaluate,
    compare,
    track,
    import_tracks,
    sim_to_real,
    view,
    scene_model,
    report,
    export,
    datasets,
    train,
    reproduce,
    tune,
)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="peopleboy")
def cli() -> None:
    """Scripted people, a robot with thermal and colour cameras, and a tracker that sees only the images."""


for command in COMMANDS:
    cli.add_command(command)


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line; a user's mistake is one line on standard error and exit code 2."""
    try:
        code = cli.main(args=arguments, prog_name="peopleboy", standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        code = BAD_INPUT
    except click.ClickException as error:
        code = _complain(error.format_message())
    except click.Abort:
        click.echo("peopleboy: interrupted", err=True)
        code = 130
    except BadInput as error:
        code = _complain(str(error))
    except (OwnCodeFailed, TasksFailed) as error:
        click.echo(f"peopleboy: {error}", err=True)
        code = FAILED
    except OSError as error:
        if error.errno not in _FULL:
            raise
        click.echo(f"peopleboy: the disk is full: {error}; make room and give the command again", err=True)
        code = FAILED
    sys.exit(code if isinstance(code, int) else 0)


def _complain(message: str) -> int:
    click.echo(f"peopleboy: {' '.join(message.split())}", err=True)
    return BAD_INPUT
