"""Generate the reference of the command line from the commands."""

from __future__ import annotations

import inspect
import re

import click

from docs.generate.markdown import table
from peopleboy.scenarios.cli import cli


def commands() -> str:
    """List all commands, followed by usage, help and options of each."""
    context = click.Context(cli, info_name="peopleboy")
    names = cli.list_commands(context)
    links = [
        (f"[`{name}`](#peopleboy-{name})", cli.commands[name].get_short_help_str(limit=200)) for name in names
    ]
    sections = [_section(cli.commands[name], context, "##") for name in names]
    return "\n".join([table(("command", "description"), links), *sections])


def _section(command: click.Command, parent: click.Context, mark: str) -> str:
    """Describe a command, and its subcommands in sections below."""
    context = click.Context(command, info_name=command.name, parent=parent)
    usage = f"{context.command_path} {' '.join(command.collect_usage_pieces(context))}"
    options = [_option(option, context) for option in command.params if isinstance(option, click.Option)]
    listed = table(("option", "description"), options) if options else ""
    about = inspect.cleandoc(command.help or "")
    section = f"{mark} {context.command_path}\n\n```text\n{usage}\n```\n\n{about}\n\n{listed}"
    if not isinstance(command, click.Group):
        return section
    own = [command.get_command(context, name) for name in command.list_commands(context)]
    return "\n".join([section, *(_section(each, context, f"{mark}#") for each in own if each is not None)])


def _option(option: click.Option, context: click.Context) -> tuple[str, str]:
    names, about = option.get_help_record(context) or ("", "")
    about = re.sub(r"  +", " ", about).replace("[", r"\[")
    return f"`{names}`", about
