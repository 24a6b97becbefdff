"""Options and help texts that several commands share."""

from __future__ import annotations

import click

SEED = "[default: 0, or that of a run's own scenario.yaml]"

# Spelled out, since the trackers themselves take a second to load, which --help should not.
TRACKERS = (
    "peopleboy, learned, footage, thesis, colour, thermal or paper; truth, which is told; "
    "or module:Class, your own"
)
tracker_option = click.option(
    "--tracker", help=f"One of {TRACKERS}.  [default: the scenario's, or peopleboy]"
)
