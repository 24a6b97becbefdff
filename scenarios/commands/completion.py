"""Shell completion for names of scenarios, suites, trackers and behaviours.

docs/tutorial/first-run.md explains how to set up a shell for it. It imports nothing slow.
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
    """Return a completion function for a fixed set of names."""
    every = sorted(names)

    def complete(context: click.Context, parameter: click.Parameter, start: str) -> list[CompletionItem]:  # noqa: ARG001
        return [CompletionItem(name) for name in every if name.startswith(start)]

    return complete


def complete_scenario(
    context: click.Context,  # noqa: ARG001
    parameter: click.Parameter,  # noqa: ARG001
    start: str,
) -> list[CompletionItem]:
    """Complete a scenario or suite of the library; if no name matches, complete a file path."""
    paths = [path for folder in ("library", "suites") for path in (_HOME / folder).glob("*.yaml")]
    names = sorted(path.stem for path in paths if path.stem.startswith(start))
    return [CompletionItem(name) for name in names] or [CompletionItem(start, type="file")]
