from __future__ import annotations

import re
from collections.abc import Sequence

import pytest

from peopleboy.studies.reproductions.experiments.catalogue import EXPERIMENTS, paper_of
from peopleboy.studies.reproductions.showing.source_contents import source_contents

# How many figures and tables each chapter of the thesis has, and the paper.
FIGURES = {1: 3, 2: 7, 3: 5, 4: 10, 5: 6, 6: 6, 7: 4}
TABLES = {3: 1, 4: 1, 5: 1, 6: 2, 7: 4}
PAPER = [f"figure {number}" for number in range(1, 6)] + [f"table {number}" for number in range(1, 4)]


def numbered(kind: str, chapters: dict[int, int]) -> list[str]:
    return [f"{kind} {chapter}.{k}" for chapter, last in chapters.items() for k in range(1, last + 1)]


@pytest.mark.parametrize(
    ("source", "wanted"),
    [("thesis", [*numbered("figure", FIGURES), *numbered("table", TABLES)]), ("2005", PAPER)],
)
def test_every_table_and_figure_of_a_source_is_listed(source: str, wanted: Sequence[str]) -> None:
    listed = {re.sub("[ab]$", "", item.what) for item in source_contents()[source]}
    assert {what for what in listed if not what.startswith("section")} == set(wanted)


def test_what_is_listed_here_is_what_is_measured() -> None:
    here = {number for items in source_contents().values() for item in items for number in item.here}
    assert here == {number for number in EXPERIMENTS if paper_of(number) in source_contents()}
