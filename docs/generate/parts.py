"""The generated parts of pages, by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

from benchmarks.results import read_tables
from docs.generate import choices
from docs.generate.commands import commands
from docs.generate.random_worlds import bearings, distribution
from docs.generate.reference.environments import environment_ids, environment_spaces, environment_tracks
from docs.generate.reference.library import gallery, library_table
from docs.generate.reference.metrics import comfort, corridor, following, goal, metrics
from docs.generate.reference.settings import settings
from docs.generate.reference.trackers import trackers
from docs.generate.results import results
from docs.generate.scenario_keys import scenario_keys
from docs.generate.sources.source_pages import PAGE, overview, whole_page
from docs.generate.sources.source_run import FOLDER, SourceRun

DOCS = Path(__file__).parents[1]
PARTS: Mapping[str, Callable[[], str]] = {
    "scenario keys": scenario_keys,
    "walls": choices.walls,
    "garments": choices.garments,
    "colours": choices.colours,
    "things": choices.things,
    "random worlds": distribution,
    "bearings": bearings,
    "commands": commands,
    "library": library_table,
    "gallery": gallery,
    "environment ids": environment_ids,
    "environment spaces": environment_spaces,
    "environment tracks": environment_tracks,
    "trackers": trackers,
    "settings": settings,
    "metrics thesis": partial(metrics, "thesis"),
    "metrics paper": partial(metrics, "paper"),
    "metrics mot": partial(metrics, "mot"),
    "metrics sets": partial(metrics, "sets"),
    "metrics floor": partial(metrics, "floor"),
    "metrics latency": partial(metrics, "latency"),
    "metrics counts": partial(metrics, "counts"),
    "metrics comfort": comfort,
    "metrics goal": goal,
    "metrics following": following,
    "metrics corridor": corridor,
    "sources": lambda: overview(SourceRun.read()),
    **{f"results {name}": partial(results, table) for name, table in read_tables().tables.items()},
}

PLACE = re.compile(r"<!-- generated: (.*?) -->.*?<!-- end -->", re.DOTALL)


def outdated_pages() -> Iterator[tuple[Path, str]]:
    """Return the pages of the documentation whose generated parts are outdated, with their new text."""
    for path in sorted(DOCS.rglob("*.md")):
        text = path.read_text(encoding="utf-8")
        new = fill_in(text)
        if new != text:
            yield path, new
    shipped, whole = FOLDER / PAGE, whole_page(SourceRun.read())
    if shipped.read_text(encoding="utf-8") != whole:
        yield shipped, whole


def fill_in(markdown: str) -> str:
    """Regenerate the parts between `<!-- generated: NAME -->` and `<!-- end -->`.

    Raises:
        KeyError: a part is unknown.
    """
    return PLACE.sub(lambda place: _part(place[1]), markdown)


def _part(name: str) -> str:
    return f"<!-- generated: {name} -->\n\n{PARTS[name]().strip()}\n\n<!-- end -->"
