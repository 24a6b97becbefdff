"""What a shell completes on the command line: names of scenarios, suites, trackers and behaviours.

A shell that is set up to ask `peopleboy` gets them, as docs/tutorial/first-run.md says. Nothing is loaded for
it that takes time.
"""

from collections.abc import Callable, Iterable
from pathlib import Path

import click
from click.shell_completion import CompletionItem

from peopleboy.behaviours.make_behaviour import BEHAVIOURS, SCRIPTED
from peopleboy.tracker.trackers import TRACKERS

TRACKER_NAMES = tuple(TRACKERS.shipped)
BEHAVIOUR_NAMES = tuple(name for name in BEHAVIOURS.shipped if name != SCRIPTED)

_HOME = Path(__file__).parents[1]
_Complete = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def complete_names(names: Iterable[str]) -> _Complete:
    """Complete one of some names."""
    every = sorted(names)

    def complete(context: click.Context, parameter: click.Parameter, start: str) -> list[CompletionItem]:  # noqa: ARG001
        return [CompletionItem(name) for name in every if name.startswith(start)]

    return complete


def complete_scenario(
    context: click.Context,  # noqa: ARG001
    parameter: click.Parameter,  # noqa: ARG001
    start: str,
) -> list[CompletionItem]:
    """Complete a scenario of the library or a suite; where none begins so, the path of a file."""
    paths = [path for folder in ("library", "suites") for path in (_HOME / folder).glob("*.yaml")]
    names = sorted(path.stem for path in paths if path.stem.startswith(start))
    return [CompletionItem(name) for name in names] or [CompletionItem(start, type="file")]
