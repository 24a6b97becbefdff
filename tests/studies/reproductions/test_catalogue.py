from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from peopleboy.random_streams import stream
from peopleboy.studies.reproductions.catalogue import EXPERIMENTS, PAPERS, choose, paper_of, read_source
from peopleboy.studies.reproductions.experiments.tracking import TrackerTrial, sequence_units
from peopleboy.studies.reproductions.plan import TRAINING, full_plan
from peopleboy.studies.reproductions.tracker_settings import BASES, TrackerSetting, changed
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.made_up_results import declaration, trials_of

FIGURES = (
    *(
        "3.4",
        "3.5",
        "4.1",
        "4.4",
        "4.5",
        "4.7",
        "4.8",
        "4.9a",
        "4.9b",
        "4.10",
        "5.3",
        "5.4",
        "5.5a",
        "5.5b",
        "5.6",
    ),
    *("6.4", "6.5", "6.6", "7.2", "7.3"),
)


TABLES = ("3.1", "4.1", "5.1", "6.1", "6.2", "7.1", "7.2", "7.3", "7.4")


PAPER = ("section-4.2", "table-1", "table-2", "table-3", "figure-4", "figure-5")


PANORAMIC = (
    *(f"figure-{number}" for number in range(1, 7)),
    *("webcams", "angle", "general", "personal", "position", "noise"),
)


SITUATION = (
    *(f"table-{number}" for number in ("3.1", "4.1", "4.2", "4.3", "4.4", "4.5", "4.7", "B.1")),
    *(f"figure-{number}" for number in ("4.25", "4.26", "4.28", "4.29", "4.30", "4.33")),
    *("scene-models", "figures-3.8-3.13"),
    *("positions", "ablations", "readings", "noise", "odometry", "pre-detection", "windows", "goals"),
    *("table-5.1", "attention-ways", "attention-times", "absence", "follow-absence"),
    *(f"figure-5.{number}" for number in (6, 7, 8, 9)),
)


ALL = {
    *(f"figure-{number}" for number in FIGURES),
    *(f"table-{number}" for number in TABLES),
    *(f"paper-{number}" for number in PAPER),
    *(f"panoramic-{name}" for name in PANORAMIC),
    *(f"situation-{name}" for name in SITUATION),
    *("section-4.2", "section-4.4", "section-5.2", "section-5.3", "section-7.5"),
}


TRACKED = [one for one in EXPERIMENTS.values() if declaration(one).get("kind") in ("tracking", "delay")]
READINGS = [
    trial for trial in trials_of(EXPERIMENTS["section-4.2"]) if trial.suites in (("dataset1",), (TRAINING,))
]


def test_every_table_and_figure_with_numbers_is_there_and_has_its_source() -> None:
    assert set(EXPERIMENTS) == ALL


def test_numbers_stand_for_all_that_have_them() -> None:
    assert [one.id for one in choose(["4.9", "7.3"])] == [
        "figure-4.9a",
        "figure-4.9b",
        "table-7.3",
        "figure-7.3",
    ]
    assert [one.id for one in choose(["paper"])] == [f"paper-{number}" for number in PAPER]
    assert [one.id for one in choose(["paper-table-2", "figure-4.9b"])] == ["figure-4.9b", "paper-table-2"]
    assert [one.id for one in choose([])] == list(EXPERIMENTS)
    for number in EXPERIMENTS:
        assert number in [one.id for one in choose([number])]


def test_papers_share_all_experiments_among_themselves() -> None:
    papers = {paper: [one.id for one in choose([], paper)] for paper in PAPERS}
    assert sorted(number for ids in papers.values() for number in ids) == sorted(ALL)
    assert papers["2005"] == [one.id for one in choose(["paper"])]
    assert papers["situation"] == [one.id for one in choose(["situation"])]
    assert papers["panoramic"] == [one.id for one in choose(["panoramic"])]
    assert [one.id for one in choose(["panoramic-figure-5"], "panoramic")] == ["panoramic-figure-5"]


def test_a_paper_that_there_is_not_and_an_id_of_another_one_are_refused() -> None:
    with refused("'2006'", "thesis, 2005, panoramic, situation"):
        choose([], "2006")
    with refused("'figure-4.8'", "panoramic-general"):
        choose(["figure-4.8"], "panoramic")


def test_an_unknown_number_is_refused_with_all_that_there_are() -> None:
    with refused("'9.9'", *EXPERIMENTS):
        choose(["9.9"])


def test_the_papers_three_tables_agree_on_its_defaults() -> None:
    tables = [EXPERIMENTS[f"paper-table-{n}"] for n in (1, 2, 3)]
    defaults = ["1000", "90 %", "30 %"]
    rows = [next(v for v in t.values if v.group == g) for t, g in zip(tables, defaults, strict=True)]
    assert rows[0].values == rows[1].values == rows[2].values
    assert len(rows[0].values) == 8


def test_every_setting_of_every_experiment_makes_a_tracker() -> None:
    trials = [trial for one in TRACKED for trial in trials_of(one)]
    for key, setting in {trial.setting.key: trial.setting for trial in trials}.items():
        assert setting.make(stream(0, key)) is not None


def test_a_change_reaches_its_place_and_nothing_else() -> None:
    config = TrackerSetting("contour", (("person.count", 300),)).config()
    assert config.person.count == 300
    assert changed(config, "person.count", BASES["contour"].person.count) == BASES["contour"]


def test_a_setting_that_does_not_exist_is_refused() -> None:
    with refused("'counts'", "count, "):
        TrackerSetting("thesis-thermal", (("person.counts", 300),)).config()


@pytest.mark.parametrize("trial", READINGS, ids=lambda trial: trial.line.group)
def test_every_reading_but_the_first_makes_another_tracker(trial: TrackerTrial) -> None:
    assert (trial.setting.config() == BASES["thesis-single"]) == (trial.line.group == "as read")


# How many figures and tables each chapter of the thesis has, and the paper.
THESIS_FIGURES = {1: 3, 2: 7, 3: 5, 4: 10, 5: 6, 6: 6, 7: 4}


THESIS_TABLES = {3: 1, 4: 1, 5: 1, 6: 2, 7: 4}


PAPER_ITEMS = [f"figure {number}" for number in range(1, 6)] + [f"table {number}" for number in range(1, 4)]


def numbered(kind: str, chapters: dict[int, int]) -> list[str]:
    return [f"{kind} {chapter}.{k}" for chapter, last in chapters.items() for k in range(1, last + 1)]


@pytest.mark.parametrize(
    ("source", "wanted"),
    [
        ("thesis", [*numbered("figure", THESIS_FIGURES), *numbered("table", THESIS_TABLES)]),
        ("2005", PAPER_ITEMS),
    ],
)
def test_every_table_and_figure_of_a_source_is_listed(source: str, wanted: Sequence[str]) -> None:
    listed = {re.sub("[ab]$", "", item.what) for item in PAPERS[source].contents}
    assert {what for what in listed if not what.startswith("section")} == set(wanted)


def test_every_table_of_the_thesis_on_situation_awareness_and_its_figures_with_results_are_listed() -> None:
    text = " ".join(item.what for item in PAPERS["situation"].contents)
    tables = ["3.1", *(f"4.{k}" for k in range(1, 8)), "5.1", "B.1"]
    assert re.findall(r"tables? ([\w.]+)", text) == tables
    figures = [
        re.findall(r"[\dAB]\.\d+", item.what)
        for item in PAPERS["situation"].contents
        if "figure" in item.what
    ]
    first_and_last = [(each[-2] if len(each) > 1 else each[0], each[-1]) for each in figures]
    chapters = [(a.split(".")[0], int(a.split(".")[1]), int(b.split(".")[1])) for a, b in first_and_last]
    covered = {(chapter, k) for chapter, a, b in chapters for k in range(a, b + 1)}
    lasts = {"1": 2, "2": 15, "3": 13, "4": 33, "5": 9, "A": 3, "B": 17}
    assert covered == {(chapter, k) for chapter, last in lasts.items() for k in range(1, last + 1)}


def test_what_is_listed_here_is_what_is_measured() -> None:
    here = {number for source in PAPERS.values() for item in source.contents for number in item.here}
    assert here == {number for number in EXPERIMENTS if PAPERS[paper_of(number)].contents}


BROKEN = """about: a paper
experiments:
  figure-1:
    title: A figure
    source: Paper, figure 1
    caption: What it shows.
    {declared}
"""


@pytest.mark.parametrize(
    ("declared", "words"),
    [
        ("measure: {kind: tracing}", ("figure-1.measure.kind", "'tracing'", "tracking")),
        ("measure: {kind: timing, times: steps}", ("figure-1.measure: timing", "'trackers'")),
        ("chart: circles", ("chart", "'circles'", "'lines'")),
    ],
)
def test_a_wrong_declaration_is_refused_with_its_place(
    declared: str, words: tuple[str, ...], tmp_path: Path
) -> None:
    path = tmp_path / "paper.yaml"
    path.write_text(BROKEN.format(declared=declared))
    with refused(str(path), *words):
        read_source(path)


def test_the_full_plan_has_all_data_sets_and_ten_repeats(tmp_path: Path) -> None:
    plan = full_plan(tmp_path)
    frames = {name: sum(p.scenario.duration_s for p in plays) * 15 for name, plays in plan.suites.items()}
    assert plan.repeats == 10
    assert frames == pytest.approx(
        {"dataset1": 1268, "dataset2": 14573, "dataset3": 4369, "dataset4": 2400}, rel=0.05
    )


@pytest.mark.thorough
def test_fewer_repeats_are_part_of_more(tmp_path: Path) -> None:
    few, all_of_them = full_plan(tmp_path, 2), full_plan(tmp_path)
    assert (few.repeats, few.pair_seeds, few.ablated, few.drives) == (2, 2, 2, 2)
    trial = trials_of(EXPERIMENTS["figure-4.8"])[0]
    keys = [{unit.key for unit in sequence_units(trial, plan, 1)} for plan in (few, all_of_them)]
    assert keys[0] == keys[1]


def test_a_quick_run_has_its_own_repeats(capsys: pytest.CaptureFixture[str]) -> None:
    assert "give either --quick or --seeds" in refusal(capsys, "reproduce", "--quick", "--seeds", "2")


def test_the_command_lists_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("reproduce", "--list", "4.9") == 0
    shown = capsys.readouterr().out
    assert "figure-4.9a" in shown
    assert "figure-4.8" not in shown


def test_the_command_lists_one_paper(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("reproduce", "--list", "--paper", "panoramic") == 0
    shown = capsys.readouterr().out
    assert "panoramic-figure-6" in shown
    assert "paper-table-1" not in shown
    assert "thesis, 2005, panoramic, situation" in refusal(capsys, "reproduce", "--paper", "2006")


CATALOGUE = "peopleboy.studies.reproductions.catalogue"


WITHOUT = f"import sys; sys.modules['pybullet'] = None; import {CATALOGUE}"


@pytest.mark.thorough
def test_what_there_is_to_reproduce_is_listed_without_pybullet() -> None:
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
