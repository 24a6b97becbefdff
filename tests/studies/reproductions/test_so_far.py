from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.engine.task import TasksFailed
from peopleboy.studies.reproductions.experiments.experiment import Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.reproductions.reproduce import Means, reproduce, show_so_far


@dataclass(frozen=True, slots=True)
class Throw:
    """Gives its number; from one on it fails."""

    number: int
    fails_from: int
    is_timing: bool = False

    @property
    def key(self) -> str:
        return f"throw {self.number} of {self.fails_from}"

    def run(self) -> Result:
        if self.number >= self.fails_from:
            raise ValueError("thrown too far")
        return {"AA": 50.0 + self.number}


@dataclass(frozen=True, slots=True)
class Thrown:
    """An experiment of one throw in each repeat."""

    id: str
    fails_from: int
    chart: str = "none"
    plotted: tuple[str, ...] = ()

    def units(self, plan: Plan) -> list[Throw]:
        return [Throw(number, self.fails_from) for number in range(plan.repeats)]

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        return missing(self.units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        return {Line("both", "default"): {"AA": np.array([done[one.key]["AA"] for one in self.units(plan)])}}


SOUND, HALF, BROKEN = Thrown("figure-4.8", 10), Thrown("figure-5.4", 2), Thrown("figure-6.4", 0)


def plan_of(tmp_path: Path, repeats: int) -> Plan:
    return Plan(cache=tmp_path / "films", repeats=repeats)


def test_what_fails_costs_only_what_needs_it_and_the_page_names_that(tmp_path: Path) -> None:
    means = Means(out=tmp_path / "out")
    with pytest.raises(TasksFailed, match=r"(?s)reproduce: 1 of 6 failed.*thrown too far"):
        reproduce([SOUND, HALF], plan_of(tmp_path, 3), means)
    sections = {part.id: part for part in show_so_far([SOUND, HALF, BROKEN], plan_of(tmp_path, 3), means)[1]}
    assert {number: part.repeats for number, part in sections.items()} == {"figure-4.8": 3, "figure-5.4": 2}
    page = (tmp_path / "out" / "index.html").read_text()
    assert "<dt>Not finished</dt><dd>figure-6.4</dd>" in page
    assert [f"{number} repeats" in page for number in (1, 2, 3)] == [False, True, True]


def test_a_folder_without_anything_finished_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no table or figure is finished there"):
        show_so_far([SOUND], plan_of(tmp_path, 3), Means(out=tmp_path / "out"))
