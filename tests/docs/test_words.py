"""Words that make a page hard to read for an engineer of the field stay out of the pages and the help."""

import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
import yaml

from peopleboy.scenarios.cli import cli
from tests.helpers.pages import DOCS

ROOT = DOCS.parent
WORDS = yaml.safe_load((Path(__file__).parent / "words.yaml").read_text(encoding="utf-8"))
PAGES = sorted([ROOT / "README.md", *DOCS.rglob("*.md")])
CODE = re.compile(r"^```.*?^```|<!--.*?-->|`[^`\n]*`|\]\([^)\n]*\)|\]\[[^\]\n]*\]", re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_a_page_has_none_of_the_words(page: Path) -> None:
    assert not list(found_in(CODE.sub(" ", page.read_text(encoding="utf-8"))))


def test_the_help_of_commands_has_none_of_the_words() -> None:
    assert not [f"{name}: {line}" for name, text in helps(cli, "peopleboy") for line in found_in(text)]


def test_every_word_has_a_reason_and_a_better_word() -> None:
    assert len(WORDS) > 20
    assert all(re.compile(row["word"]) and row["reason"] and row["better"] for row in WORDS)


def found_in(text: str) -> Iterator[str]:
    """Find words of the list: the word, its surroundings, and what to write instead."""
    flat = " ".join(text.split())
    for row in WORDS:
        for found in re.finditer(row["word"], flat, re.IGNORECASE):
            yield f"...{flat[max(0, found.start() - 40) : found.end() + 30]}... (write: {row['better']})"


def helps(command: click.Command, name: str) -> Iterator[tuple[str, str]]:
    """List the help texts of a command and of those below it."""
    yield name, command.help or ""
    for option in command.params:
        if isinstance(option, click.Option) and option.help:
            yield f"{name} {option.opts[0]}", option.help
    if isinstance(command, click.Group):
        for key, child in command.commands.items():
            yield from helps(child, f"{name} {key}")
