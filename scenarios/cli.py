"""The command line: `peopleboy`."""

import errno
import sys
from collections.abc import Mapping, Sequence
from typing import Any, Final

import click

from peopleboy.bad_input import BadInput, shortened
from peopleboy.own_code import OwnCodeFailed
from peopleboy.scenarios.commands.command_options import british
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
from peopleboy.scenarios.commands.study_commands import datasets, export_onnx, reproduce, train, tune
from peopleboy.scenarios.running.engine.task import TasksFailed

FAILED = 1
BAD_INPUT = 2
_FULL: Final = "the disk is full; free some space and run the command again"
_MANY: Final = "too few file descriptors; raise the limit, for example with `ulimit -n 1024`"
_ADVICE: Final = {
    errno.ENOSPC: _FULL,
    errno.EDQUOT: _FULL,
    errno.EMFILE: _MANY,
    errno.ENFILE: _MANY,
    errno.ENOENT: "a file or folder was removed in the meantime; run the command again",
    errno.ENAMETOOLONG: "give a shorter name",
}
"""What to do about errors of the system."""

_ELSE: Final = "check the path, its rights and its disk"

SECTIONS: Final[Mapping[str, tuple[click.Command, ...]]] = {
    "Core": (list_command, show, run, sweep, view, report),
    "Score": (evaluate, compare, import_tracks),
    "Data": (track, render, export, scene_model, schema),
    "Research": (datasets, reproduce, tune, train, export_onnx, sim_to_real),
}
"""Commands, grouped by the headings of the help."""

COMMANDS: Final = tuple(command for commands in SECTIONS.values() for command in commands)


class _Sections(click.Group):
    """A group whose help lists the commands by section."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        """List the names of the commands in the order of the sections."""
        return list(self.commands)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write a list of commands for each section."""
        width = max(len(name) for name in self.commands)
        for title, commands in SECTIONS.items():
            with formatter.section(title):
                limit = formatter.width - width - 6
                rows = [(f"{one.name:{width}}", one.get_short_help_str(limit)) for one in commands]
                formatter.write_dl(rows)


_SETTINGS: Final = {
    "help_option_names": ["-h", "--help"],
    "max_content_width": 100,
    "token_normalize_func": british,
}


@click.group(cls=_Sections, context_settings=_SETTINGS)
@click.version_option(package_name="peopleboy")
def cli() -> None:
    """Simulate, track and evaluate people around a mobile robot.

    A scenario describes people and a robot with thermal, colour and depth cameras. Try `peopleboy run
    crossing_2`: it simulates a scenario, tracks its people, and records exact ground truth for every image.
    `peopleboy COMMAND --help` describes a command.
    """


for command in COMMANDS:
    cli.add_command(command)


def main(arguments: Sequence[str] | None = None) -> Any:
    """Run the command line; invalid input prints one line on standard error and exits with code 2."""
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
        code = max(map(_complain, error.lines))
    except (OwnCodeFailed, TasksFailed) as error:
        click.echo(f"peopleboy: {error}", err=True)
        code = FAILED
    except OSError as error:
        if error.errno is None:  # raised by a library, not by the system
            raise
        advice = _ADVICE.get(error.errno, _ELSE)
        click.echo(f"peopleboy: {shortened(str(error))}; {advice}", err=True)
        code = BAD_INPUT if error.errno == errno.ENAMETOOLONG else FAILED
    sys.exit(code if isinstance(code, int) else 0)


def _complain(message: str) -> int:
    click.echo(f"peopleboy: {shortened(' '.join(message.split()))}", err=True)
    return BAD_INPUT
