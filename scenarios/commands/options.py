"""Options and help texts that several commands share."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any

import click

from peopleboy.scenarios.commands.completion import BEHAVIOUR_NAMES, TRACKER_NAMES, complete_names

SEED = "[default: 0, or that of a run's own scenario.yaml]"

# The names are spelled out, since the trackers themselves take a second to load, which --help should not.
TRACKERS = (
    f"{', '.join(TRACKER_NAMES[:-1])} or {TRACKER_NAMES[-1]}; truth, which is told; or module:Class, your own"
)
complete_trackers = complete_names((*TRACKER_NAMES, "truth"))
tracker_option = click.option(
    "--tracker",
    shell_complete=complete_trackers,
    help=f"One of {TRACKERS}.  [default: the scenario's, or detection]",
)
behaviour_option = click.option(
    "--behaviour",
    shell_complete=complete_names(BEHAVIOUR_NAMES),
    help="What drives the robot: stand, follow_person, follow_corridor or patrol; or module:Class, your "
    "own.  [default: the scenario's]",
)
physics_option = click.option(
    "--physics",
    type=click.Choice(["bullet", "kinematic"]),
    help="What moves the robot: PyBullet, or rolling without slip, which needs no PyBullet.  "
    "[default: the scenario's]",
)

BOXES = click.Choice(["torso", "whole"])
boxes_option = click.option(
    "--boxes",
    type=BOXES,
    default="torso",
    show_default=True,
    help="What the tracker's boxes are drawn round, and so the truth's by which they are scored: the torso, "
    "or all of a person, as most detectors do.",
)


class WholeNumber(click.IntRange):
    """A whole number within limits, refused with what would be right."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Read it."""
        try:
            return int(super().convert(value, param, ctx))
        except click.BadParameter:
            return self.fail(f"must be a whole number {_limits(self)}, got {value}", param, ctx)


class Number(click.FloatRange):
    """A number within limits, refused with what would be right."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Read it."""
        try:
            number = float(super().convert(value, param, ctx))
        except click.BadParameter:
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"must be a number {_limits(self)}, got {value}", param, ctx)
        return number


def _limits(number: WholeNumber | Number) -> str:
    if number.max is None:
        return f"of at least {number.min:g}"
    return f"from {number.min:g} to {'less than ' * number.max_open}{number.max:g}"


_COUNT = "Processes at the same time; 1 for none but this one.  [default: one a core]"
_ADDRESS = "Work on the cluster of this Dask scheduler instead."


def workers_options(command: Callable[..., None]) -> Callable[..., None]:
    """Let a command say who does the work; `chosen_workers` takes both."""
    scheduler = click.option("--scheduler", metavar="tcp://...", help=_ADDRESS)
    return click.option("--workers", type=WholeNumber(min=1), help=_COUNT)(scheduler(command))


@dataclass(frozen=True, slots=True)
class Output:
    """What of its figures a command prints.

    Attributes:
        as_json: figures as one JSON document, and nothing else.
        is_quiet: nothing else in any case, not even progress.
    """

    as_json: bool
    is_quiet: bool

    @property
    def is_wordy(self) -> bool:
        """Whether people are to be told."""
        return not (self.as_json or self.is_quiet)

    def figures(self, give: Callable[[], object], show: Callable[[], None] = lambda: None) -> None:
        """Give figures as JSON, or show them to people."""
        if self.as_json:
            click.echo(json.dumps(give(), indent=2))
        elif self.is_wordy:
            show()


def output_options(command: Callable[..., None]) -> Callable[..., None]:
    """Let a command, which takes an `Output` named output, say how its figures are to be printed."""

    @wraps(command)
    def with_output(*arguments: Any, as_json: bool, quiet: bool, **options: Any) -> None:
        output = Output(as_json, quiet)
        if quiet:
            from peopleboy.scenarios.progress_bar import no_progress

            with no_progress():
                command(*arguments, output=output, **options)
        else:
            command(*arguments, output=output, **options)

    as_json = click.option("--json", "as_json", is_flag=True, help="Print figures alone, as a JSON document.")
    quiet = click.option("--quiet", is_flag=True, help="Print nothing but what --json asks for, and errors.")
    return as_json(quiet(with_output))


def tell_note(text: str) -> None:
    """Print what was taken as something else than it is."""
    click.echo(f"peopleboy: note: {text}", err=True)
