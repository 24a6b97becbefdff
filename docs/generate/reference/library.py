"""Generate the table and the gallery of the scenario library."""

from __future__ import annotations

import html
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import yaml

from docs.generate.markdown import table
from peopleboy.scenarios.files.library import library

GROUPS: Final = Path(__file__).parent / "library.yaml"


@dataclass(frozen=True, slots=True)
class LibraryGroup:
    """Scenarios that test the same ability."""

    title: str
    tests: str
    scenarios: tuple[str, ...]


def library_groups() -> tuple[LibraryGroup, ...]:
    """Read the groups of the library in the order of the pages."""
    data = yaml.safe_load(GROUPS.read_text(encoding="utf-8"))["groups"]
    return tuple(LibraryGroup(row["title"], row["tests"], tuple(row["scenarios"])) for row in data)


def library_table() -> str:
    """Return the table of groups with their scenarios."""
    rows = [
        (f"[{group.title}](../gallery.md#{_anchor(group.title)})", group.tests, _names(group))
        for group in library_groups()
    ]
    return table(("group", "what it tests", "scenarios"), rows)


def gallery() -> str:
    """Return one section per group, with plan, name and description of each scenario."""
    return "\n\n".join(_section(group) for group in library_groups())


def _section(group: LibraryGroup) -> str:
    described = library()
    cards = "\n".join(_card(name, described[name].description) for name in group.scenarios)
    return f'## {group.title}\n\n**What they test:** {group.tests}\n\n<div class="gallery">\n{cards}\n</div>'


def _card(name: str, description: str) -> str:
    picture = f"pictures/gallery/{name}.webp"
    return (
        f'<figure><a href="{picture}"><img src="{picture}" alt="Plan of {name}" loading="lazy"></a>'
        f"<figcaption><code>{name}</code> {html.escape(description)}</figcaption></figure>"
    )


def _names(group: LibraryGroup) -> str:
    return ", ".join(f"`{name}`" for name in group.scenarios)


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")
