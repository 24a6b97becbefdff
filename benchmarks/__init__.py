"""Benchmarks of speed and quality, with ratios to a named peer in the same run."""

import click

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import TasksFailed


def call(command: click.Command, name: str) -> None:
    """Run the command of `python -m NAME`; errors print one line, with exit code 2 for bad input, else 1."""
    try:
        command.main(standalone_mode=False)
    except (BadInput, click.ClickException) as error:
        _end(name, error, 2)
    except TasksFailed as error:
        _end(name, error, 1)


def _end(name: str, error: Exception, code: int) -> None:
    message = error.format_message() if isinstance(error, click.ClickException) else str(error)
    click.echo(f"{name}: {message}", err=True)
    raise SystemExit(code) from error
