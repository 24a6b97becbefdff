from __future__ import annotations

import re
from dataclasses import fields, is_dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest

from docs.generate.sources.source_run import SourceRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.catalogue import EXPERIMENTS, choose
from peopleboy.studies.reproductions.experiment import ExperimentOutcome, Jackknife, Line
from peopleboy.studies.reproductions.experiments.sequence_scores import RECORDS
from peopleboy.studies.reproductions.experiments.tracking import count_unit, sequence_units
from peopleboy.studies.reproductions.plan import full_plan
from peopleboy.studies.reproductions.runner import print_sections
from peopleboy.studies.reproductions.source_page import PageHead, page_text, section
from peopleboy.studies.reproductions.units import Measurement
from tests.helpers.made_up_results import made_up, trials_of
from tests.helpers.visible_text import assert_reads_as

DRAWN = (
    "figure-3.4",
    "figure-3.5",
    "figure-5.3",
    "figure-4.4",
    "figure-7.2",
    "paper-figure-4",
    *(f"panoramic-figure-{number}" for number in range(1, 7)),
)


PICTURE = dict.fromkeys(DRAWN, "data:image/png;base64,AAAA")


class Addresses(HTMLParser):
    """Collects what a page would fetch, and the names that it can be jumped to."""

    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.ids: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id":
                self.ids.add(str(value))
            elif name in ("src", "srcset", "poster", "data") or (name == "href" and tag != "a"):
                self.fetched.append(str(value))


def read(page: Path) -> tuple[str, Addresses]:
    text, addresses = page.read_text(encoding="utf-8"), Addresses()
    addresses.feed(text)
    return text, addresses


@pytest.mark.thorough
def test_the_page_holds_everything_and_fetches_nothing(tmp_path: Path) -> None:
    results = [
        section(ExperimentOutcome(one, made_up(one), PICTURE.get(one.id))) for one in EXPERIMENTS.values()
    ]
    about = PageHead(command="peopleboy reproduce", is_quick=True, amount="Little.", facts={"Python": "3"})
    (tmp_path / "index.html").write_text(page_text(results, about), encoding="utf-8")
    text, addresses = read(tmp_path / "index.html")
    assert addresses.ids >= set(EXPERIMENTS)
    charts = [one for one in EXPERIMENTS.values() if one.chart != "none"]
    assert len(addresses.fetched) == len(charts) + len(PICTURE)
    kinds = ("data:image/svg+xml;base64,", "data:image/png;base64,")
    assert all(address.startswith(kinds) for address in addresses.fetched)
    assert not re.search(r"https?://|@import|url\(|<script", text)
    for number in ("94.61", "89.38 ± 2.48", "2709", "72.20", "Athlon XP 2 GHz"):
        assert number in text


def test_a_page_of_four_sections_reads_as_it_did(tmp_path: Path) -> None:
    chosen = choose(["figure-4.8", "figure-4.9b", "panoramic-position", "panoramic-figure-1"])
    results = [section(ExperimentOutcome(one, made_up(one), PICTURE.get(one.id))) for one in chosen]
    about = PageHead(command="peopleboy reproduce", is_quick=True, amount="Little.", facts={"Python": "3"})
    (tmp_path / "page.html").write_text(page_text(results, about), encoding="utf-8")
    assert_reads_as(tmp_path / "page.html", Path(__file__).with_name("page_of_four_sections.txt"))


def test_sections_are_printed_with_both_figures_and_both_tests(capsys: pytest.CaptureFixture[str]) -> None:
    (position,) = choose(["panoramic-position"])
    print_sections([section(ExperimentOutcome(position, made_up(position)))])
    told = capsys.readouterr().out
    for words in (
        "0.154 ± 0.094",
        "0.145 ± 0.092",
        "paired by stretches of time: t =",
        "unpaired: t =",
        "d_z =",
    ):
        assert words in told


SWEEP = EXPERIMENTS["figure-4.9a"]


def nothing(kind: type) -> Result:
    """Give the plain data of a record of sums that are all 0."""
    hints = get_type_hints(kind)
    return {
        field.name: nothing(hints[field.name]) if is_dataclass(hints[field.name]) else 0
        for field in fields(kind)
    }


class Seen(dict[str, Result]):
    """Results of every film by every tracker: of film n (from 0), 90 - n of 100 people found, none false."""

    def __init__(self) -> None:
        super().__init__()
        plan = full_plan(Path("films"), 1)
        for trial in trials_of(SWEEP):
            for number, unit in enumerate(sequence_units(trial, plan, 0)):
                result = {name: nothing(kind) for name, kind in RECORDS.items()}
                result["thesis"]["matches"] = 90 - number
                result["thesis"]["areas"] |= {"targets": 100, "candidates": 90 - number}
                self[unit.key] = {trial.rule: result}
            self |= {count_unit(run, plan.cache).key: {} for run in plan.runs(trial.suites)}


def test_a_sweep_of_one_repeat_keeps_what_each_film_does_through_the_shipped_run(tmp_path: Path) -> None:
    assert SWEEP.measure is not None
    samples = SWEEP.measure(Measurement(full_plan(Path("films"), 1), Seen()))
    found = samples[Line("100", "default")]["CR"]
    assert isinstance(found, Jackknife)
    np.testing.assert_allclose(found.by_sequence, 90.0 - np.arange(10))
    outcome = ExperimentOutcome(SWEEP, samples)
    assert (outcome.repeats, outcome.sequences) == (1, 10)
    head = PageHead(command="peopleboy reproduce", is_quick=False, amount="All.", facts={})
    SourceRun(head, (outcome,)).write(tmp_path)
    (back,) = SourceRun.read(tmp_path).outcomes
    again = back.samples[Line("100", "default")]["CR"]
    assert isinstance(again, Jackknife)
    np.testing.assert_allclose(again.by_sequence, found.by_sequence, atol=1e-3)
    assert "1 repeat, intervals over 10 sequences" in page_text([section(back)], head)
