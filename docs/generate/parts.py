"""Every generated part of a page by its name."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial

from docs.generate import choices
from docs.generate.commands import commands
from docs.generate.metrics import metrics
from docs.generate.scenario_keys import scenario_keys
from docs.generate.settings import settings
from docs.generate.trackers import trackers

PARTS: Mapping[str, Callable[[], str]] = {
    "scenario keys": scenario_keys,
    "walls": choices.walls,
    "garments": choices.garments,
    "colours": choices.colours,
    "things": choices.things,
    "postures": choices.postures,
    "behaviours": choices.behaviours,
    "faults": choices.faults,
    "commands": commands,
    "trackers": trackers,
    "settings": settings,
    "metrics thesis": partial(metrics, "thesis"),
    "metrics paper": partial(metrics, "paper"),
    "metrics mot": partial(metrics, "mot"),
    "metrics counts": partial(metrics, "counts"),
}

PLACE = re.compile(r"<!-- generated: (.*?) -->")


def fill_in(markdown: str) -> str:
    """Put the parts that a page asks for into it.

    Raises:
        KeyError: there is no part of that name.
    """
    return PLACE.sub(lambda place: PARTS[place[1]](), markdown)
