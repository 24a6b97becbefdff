"""How fast things are: medians, and ratios against a named peer in the same run."""

from __future__ import annotations

import click

from peopleboy.bad_input import BadInput


def call(command: click.Command, name: str) -> None:
    """Call `python -m NAME`; what the user got wrong is one line, and exit code 2."""
    try:
        command.main(standalone_mode=False)
    except (BadInput, click.ClickException) as error:
        click.echo(f"{name}: {error}", err=True)
        raise SystemExit(2) from error
