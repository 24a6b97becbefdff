"""Options and help texts that several commands share."""

from __future__ import annotations

from collections.abc import Callable

import click

SEED = "[default: 0, or that of a run's own scenario.yaml]"

# Spelled out, since the trackers themselves take a second to load, which --help should not.
TRACKERS = (
    "peopleboy, learned, anywhere, thesis, colour, thermal, paper, panoramic-paper, panoramic, handover, "
    "rgbd, rgbd-printed, fused, attentive, attentive-printed or attentive-fused; truth, which is told; or "
    "module:Class, your own"
)
tracker_option = click.option(
    "--tracker", help=f"One of {TRACKERS}.  [default: the scenario's, or peopleboy]"
)
behaviour_option = click.option(
    "--behaviour",
    help="What drives the robot: stand, follow_person, follow_corridor or patrol; or module:Class, your "
    "own.  [default: the scenario's]",
)

_COUNT = "Processes at the same time; 1 for none but this one.  [default: one a core]"
_ADDRESS = "Work on the cluster of this Dask scheduler instead."


def workers_options(command: Callable[..., None]) -> Callable[..., None]:
    """Let a command say who does the work; `chosen_workers` takes both."""
    scheduler = click.option("--scheduler", metavar="tcp://...", help=_ADDRESS)
    return click.option("--workers", type=click.IntRange(min=1), help=_COUNT)(scheduler(command))
