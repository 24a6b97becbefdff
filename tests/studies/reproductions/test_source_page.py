from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import cv2
import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.evaluations.attention_focus import CHOICES as WAYS
from peopleboy.studies.reproductions.evaluations.drive_tracking import CHOICES
from peopleboy.studies.reproductions.evaluations.scene_scores import CHOICES as SCENE_MODELS
from peopleboy.studies.reproductions.evaluations.scene_scores import CLEAN
from peopleboy.studies.reproductions.evaluations.sliding_windows import (
    BY_SIZE,
    FAR_SLIDES,
    NEAR_SLIDES,
    PARTS,
)
from peopleboy.studies.reproductions.experiments.attention import TRACKERS
from peopleboy.studies.reproductions.experiments.catalogue import EXPERIMENTS, PAPERS, choose
from peopleboy.studies.reproductions.experiments.distances import CUES, Correlations, Distances
from peopleboy.studies.reproductions.experiments.experiment import (
    Depicted,
    Experiment,
    Line,
    Outcome,
    Samples,
)
from peopleboy.studies.reproductions.experiments.tracking import THESIS, Tracking, units_of
from peopleboy.studies.reproductions.measuring.tracker_settings import BASES, Setting, changed
from peopleboy.studies.reproductions.measuring.units import RECORDS, TrackUnit, restored
from peopleboy.studies.reproductions.measuring.window_units import MACHINES
from peopleboy.studies.reproductions.measuring.workload import Plan, full_plan
from peopleboy.studies.reproductions.reproduce import MEANS, RESULTS, Means, reproduce
from peopleboy.studies.reproductions.showing.against_source import ClaimStatus, judge
from peopleboy.studies.reproductions.showing.print_sections import print_sections
from peopleboy.studies.reproductions.showing.source import Claim, source_tables
from peopleboy.studies.reproductions.showing.source_page import (
    PageHead,
    below_source,
    section,
    write_page,
)
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors
from peopleboy.tracker.evaluation.area_metrics import PaperMetrics
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.some_of import some_of
from tests.helpers.visible_text import assert_reads_as

FIGURES = (
    *("3.4", "3.5", "4.4", "4.8", "4.9a", "4.9b", "5.3", "5.4", "5.5a", "5.5b", "5.6"),
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
    *("positions", "ablations", "noise", "odometry", "pre-detection", "windows", "goals"),
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


DRIVES = Plan(cache=Path("films"), drives=2)


ERRORS = {"mean": 9.0, "deviation": 30.0, "median": 1.0, "known": 0.99}
EVENTS = {"right": 3, "false": 1, "events": 3, "told": 2, "asked": 2, "named": 1}
COUNTS = {"people": [9, 1, 1], "things": [8, 1, 2], "events": EVENTS}
SCENE = {"clean": ERRORS, "ever": ERRORS, "ms": 5.0} | COUNTS
MAP = base64.b64encode(cv2.imencode(".png", np.full((8, 10), 3000, np.uint16))[1].tobytes()).decode()


class MadeUp(dict[str, Result]):
    """Results of drives, windows, films and times, all of them invented."""

    def __missing__(self, key: str) -> Result:
        if key.startswith("windows "):
            return {f"{kind} {who}": {"people": [1.0, 2.0], "others": [-1.0]} for kind, who in MACHINES}
        if key.startswith("scene "):
            return dict.fromkeys(SCENE_MODELS, SCENE) | {"maps": dict.fromkeys((*SCENE_MODELS, CLEAN), MAP)}
        if key.startswith("slide "):
            tally = {"ms": 10.0, "images": 3, "people": 4, "found": 3, "false": 5}
            kinds = (f"{one} {BY_SIZE}" for one in ("near+far", "far", "near"))
            slides = (how.key for how in (*FAR_SLIDES, *NEAR_SLIDES))
            return dict.fromkeys((*slides, *kinds), tally) | {"parts": dict.fromkeys(PARTS, 3.0)}
        if key.startswith("focus "):
            return {name: {"1": [6, 2, 2], "2": [9, 0, 1]} for name in WAYS}
        if key.startswith("absence "):
            return {name: {"away": 50, "accepted": 1, "late_s": 0.5, "found_s": 0.4} for name in TRACKERS}
        if key.startswith("follow "):
            return {"images": 90, "right": 30, "wrong": 1, "absences": 2, "resumed": 2}
        if key.startswith("time "):
            return {"maps": 6.0, "maps, patterns and their sums": 12.0}
        if key.startswith("picture "):
            return {"picture": "data:image/png;base64,"}
        truth = [[1, 1, 2.0, 0.5, 2.0, 0.0, 1], [2, 1, 4.0, 0.5, 4.0, 0.0, 1], [3, 1, 6.0, 0.5, 6.0, 0.0, 1]]
        told = [[frame, 1, x, y + 0.1] for frame, _, x, y, *_ in truth]
        hits = [[frame, 1, 1, 0.0, 0.1, 0.0, 0.1] for frame, *_ in truth]
        pre = {"bands": [[3, 3], [2, 1], [2, 1], [2, 0]], "false": 1}
        seen = {
            "frames": 3,
            "hits": hits,
            "missed": [[3, 2]],
            "false": [],
            "ms": 9.0,
            "pre": pre,
            "told": told,
        }
        robot = [[0.1 * frame, 0.0, 0.0] for frame in range(3)]
        return dict.fromkeys(CHOICES, seen) | {"truth": truth, "robot": robot, "depth": told, "legs": told}


def made_up(experiment: Experiment) -> Samples:
    """Invent figures for every line that an experiment has in the source or in its trials."""
    rng = np.random.default_rng(0)
    if isinstance(experiment, Distances):
        return {Line(group, "room_long, random split"): {"m": errors(rng)} for group in experiment.picks}
    if isinstance(experiment, Correlations):
        return {Line(cue, "room_long"): {"|r|": rng.uniform(0.5, 0.9, 3)} for cue in CUES}
    if experiment.id.startswith("situation-"):
        return experiment.samples(DRIVES, MadeUp())
    if isinstance(experiment, Tracking):
        return {t.line: {m: rng.uniform(50, 90, 3) for m in experiment.metrics} for t in experiment.trials}
    values = source_tables()[experiment.id].values
    return {Line(v.group, "default"): {name: rng.uniform(50, 90, 3) for name in v.figures} for v in values}


def errors(rng: np.random.Generator) -> ImageErrors:
    """Invent two splits of a film of 400 images."""
    rows = [np.sort(rng.permutation(400)[:280]) for _ in range(2)]
    return ImageErrors.of([(part, rng.exponential(0.1, 280)) for part in rows], 400)


def test_every_table_and_figure_with_numbers_is_there_and_has_its_source() -> None:
    assert set(EXPERIMENTS) == set(source_tables()) == ALL


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


@pytest.mark.slow
@pytest.mark.parametrize(
    "number", some_of([f"situation-{name}" for name in SITUATION if name.startswith("figure")], 4)
)
def test_figures_of_drives_are_drawn(number: str) -> None:
    experiment = EXPERIMENTS[number]
    assert isinstance(experiment, Depicted)
    assert str(experiment.picture(DRIVES, MadeUp())).startswith("data:image/png;base64,")


@pytest.mark.slow
def test_goals_are_reached_or_not_by_what_was_measured() -> None:
    samples = made_up(EXPERIMENTS["situation-goals"])
    figures = {line.group: figures["figure"].tolist() for line, figures in samples.items()}
    assert figures["rate"] == figures["rate of the worst set"] == [0.75]
    assert figures["error, mean [m]"] == pytest.approx([0.1])
    assert figures["false sizes per image"] == pytest.approx([1.0 / 3.0])
    assert figures["switches a run in turns, saved by odometry"] == [0.0]


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


@pytest.mark.parametrize("number", sorted(ALL))
def test_figures_and_claims_of_the_source_meet_lines_and_columns_of_ours(number: str) -> None:
    samples, table = made_up(EXPERIMENTS[number]), source_tables()[number]
    columns = {name for figures in samples.values() for name in figures}
    groups = {line.group for line in samples}
    for value in table.values:
        assert value.group in groups
        assert set(value.figures) <= columns
    for claim in table.claims:
        assert set(claim.groups) <= groups
        assert claim.metric in columns
        assert list(judge(claim, samples))


def test_the_papers_three_tables_agree_on_its_defaults() -> None:
    tables = [source_tables()[f"paper-table-{n}"] for n in (1, 2, 3)]
    defaults = ["1000", "90 %", "30 %"]
    rows = [next(v for v in t.values if v.group == g) for t, g in zip(tables, defaults, strict=True)]
    assert rows[0].figures == rows[1].figures == rows[2].figures
    assert len(rows[0].figures) == 8


def test_every_setting_of_every_experiment_makes_a_tracker() -> None:
    trials = [trial for one in EXPERIMENTS.values() if isinstance(one, Tracking) for trial in one.trials]
    for key, setting in {trial.setting.key: trial.setting for trial in trials}.items():
        assert setting.make(stream(0, key)) is not None


def test_a_change_reaches_its_place_and_nothing_else() -> None:
    config = Setting("contour", (("person.count", 300),)).config()
    assert config.person.count == 300
    assert changed(config, "person.count", BASES["contour"].person.count) == BASES["contour"]


def test_a_setting_that_does_not_exist_is_refused() -> None:
    with refused("'counts'", "count, "):
        Setting("thesis-thermal", (("person.counts", 300),)).config()


A, B = Line("a", "default"), Line("b", "default")


@pytest.mark.parametrize(
    ("expect", "by", "first", "second", "outcome"),
    [
        ("more", None, [71.0, 70.0], [60.0, 69.5], ClaimStatus.UNCLEAR),
        ("more", None, [71.0, 72.1, 70.9], [61.0, 62.0, 61.0], ClaimStatus.HOLDS),
        ("more", 15.0, [71.0, 72.1, 70.9], [61.0, 62.0, 61.0], ClaimStatus.HOLDS),
        ("more", 15.0, [71.39, 70.0, 72.0], [70.0, 68.7, 70.5], ClaimStatus.WEAKER),
        ("more", 15.0, [71.0, 70.0, 72.0], [70.5, 70.1, 71.9], ClaimStatus.FAILS),
        ("less", None, [71.0, 72.1, 70.9], [61.0, 62.0, 61.0], ClaimStatus.FAILS),
        ("less", -8.0, [61.0, 62.0, 61.0], [71.0, 72.1, 70.9], ClaimStatus.HOLDS),
        ("more", None, [71.0], [61.0], ClaimStatus.UNCLEAR),
        ("alike", None, [71.0, 70.5, 70.2], [70.5, 70.1, 70.0], ClaimStatus.HOLDS),
        ("alike", None, [71.0, 70.0], [69.5, 70.0], ClaimStatus.UNCLEAR),
        ("alike", None, [75.0, 75.2, 75.1], [69.5, 70.0, 69.6], ClaimStatus.FAILS),
        ("no less", None, [75.0, 75.2, 75.1], [69.5, 70.0, 69.6], ClaimStatus.HOLDS),
        ("no less", None, [66.0, 67.0, 66.5], [69.5, 70.0, 69.6], ClaimStatus.FAILS),
        ("differs", 3.0, [71.0, 72.1, 70.9], [61.0, 62.0, 61.0], ClaimStatus.HOLDS),
        ("differs", 3.0, [61.1, 62.1, 61.1], [61.0, 62.0, 61.0], ClaimStatus.FAILS),
        ("differs", None, [61.0, 62.0], [61.0, 62.0], ClaimStatus.FAILS),
        ("more", None, [1.0, 1.0], [0.0, 0.0], ClaimStatus.BLIND),
        ("more", None, [np.nan, 1.0], [0.0, 0.0], ClaimStatus.UNKNOWN),
    ],
)
def test_claims_are_judged_by_the_interval_of_the_difference(
    expect: str, by: float | None, first: list[float], second: list[float], outcome: ClaimStatus
) -> None:
    claim = Claim(says="x", metric="AA", groups=("a", "b"), expect=expect, by=by)  # type: ignore[arg-type]
    samples = {A: {"AA": np.array(first)}, B: {"AA": np.array(second)}}
    assert [verdict.outcome for verdict in judge(claim, samples)] == [outcome]


@pytest.mark.parametrize(
    ("first", "outcome"),
    [
        ([30.0, 31.0, 30.5], ClaimStatus.WEAKER),
        ([600.0, 610.0, 590.0], ClaimStatus.HOLDS),
        ([9.0, 9.5, 9.2], ClaimStatus.FAILS),
    ],
)
def test_a_claim_of_a_hundred_times_asks_for_half_of_that(first: list[float], outcome: ClaimStatus) -> None:
    claim = Claim(says="x", metric="ms", groups=("a", "b"), expect="more", times=100.0)
    samples = {A: {"ms": np.array(first)}, B: {"ms": np.array([10.0, 10.1, 10.2])}}
    (found,) = judge(claim, samples)
    assert found.outcome == outcome
    assert found.times == pytest.approx(np.mean(first) / 10.1)


def test_what_the_default_does_not_reach_is_listed_once_for_sure_or_not() -> None:
    figures = {"default": 65.0, "default, strict": 50.0, "default, half in view": 50.0, "literal": 50.0}
    samples = {
        Line(group, who): {"AA": np.array([figure, figure + 0.1])}
        for group, more in (("1000", 0.0), ("2000", 10.0))
        for who, figure in ((who, figure + more) for who, figure in figures.items())
    }
    part = section(Outcome(EXPERIMENTS["figure-5.5a"], samples))
    found = [(number, one.group, one.who, one.standing.value) for number, one in below_source([part, part])]
    assert found == [
        ("figure-5.5a", "1000", "default", "as the source"),
        ("figure-5.5a", "1000", "default, strict", "worse"),
        ("figure-5.5a", "2000", "default, strict", "worse"),
    ]


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
    results = [section(Outcome(one, made_up(one), PICTURE.get(one.id))) for one in EXPERIMENTS.values()]
    about = PageHead(command="peopleboy reproduce", is_quick=True, amount="Little.", facts={"Python": "3"})
    write_page(tmp_path / "index.html", results, about)
    text, addresses = read(tmp_path / "index.html")
    assert addresses.ids >= ALL
    charts = [one for one in EXPERIMENTS.values() if one.chart != "none"]
    assert len(addresses.fetched) == len(charts) + len(PICTURE)
    kinds = ("data:image/svg+xml;base64,", "data:image/png;base64,")
    assert all(address.startswith(kinds) for address in addresses.fetched)
    assert not re.search(r"https?://|@import|url\(|<script", text)
    for number in ("94.61", "89.38 ± 2.48", "2709", "72.20", "Athlon XP 2 GHz"):
        assert number in text


def test_a_page_of_four_sections_reads_as_it_did(tmp_path: Path) -> None:
    chosen = choose(["figure-4.8", "figure-4.9b", "panoramic-position", "panoramic-figure-1"])
    results = [section(Outcome(one, made_up(one), PICTURE.get(one.id))) for one in chosen]
    about = PageHead(command="peopleboy reproduce", is_quick=True, amount="Little.", facts={"Python": "3"})
    write_page(tmp_path / "page.html", results, about)
    assert_reads_as(tmp_path / "page.html", Path(__file__).with_name("page_of_four_sections.txt"))


def toy_runs() -> Iterator[tuple[str, tuple[SuiteRun, ...]]]:
    pair = SuiteRun(load_scenario("crossing_pair").lasting(1.5), 0)
    single = SuiteRun(load_scenario("single_stationary").lasting(1.5), 0)
    for number, play in enumerate((single, single, pair, pair), 1):
        yield f"dataset{number}", (play,)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("numbers", "units", "says"),
    [
        pytest.param(("4.8",), 5, "figure-4.8", id="one figure"),
        pytest.param(
            ("3.1", "4.1", "4.8", "5.5", "figure-7.3", "paper-table-3"),
            31,
            "Left out of this run: 300, 2000.",
            marks=pytest.mark.thorough,
            id="a little of everything",
        ),
    ],
)
def test_what_is_chosen_becomes_a_page_and_is_done_once(
    numbers: tuple[str, ...], units: int, says: str, tmp_path: Path
) -> None:
    plan = Plan(cache=tmp_path / "films", suites=dict(toy_runs()), repeats=2, is_quick=True, timing_steps=2)
    chosen = choose(numbers)
    page, _ = reproduce(chosen, plan, Means(out=tmp_path))
    assert read(page)[1].ids >= {one.id for one in chosen}
    assert says in page.read_text(encoding="utf-8")
    means = json.loads((tmp_path / MEANS).read_text())
    assert set(means) == {one.id for one in chosen}
    assert means["figure-4.8"]["dataset1"]["default"].keys() == set(THESIS)
    lines = [json.loads(line) for line in (tmp_path / RESULTS).read_text().splitlines()]
    assert sum(line["spent_s"] for line in lines) > 0.0
    done = [line["key"] for line in lines]
    assert len(done) == len(set(done)) >= units
    assert reproduce(chosen, plan, Means(out=tmp_path))[0] == page
    assert len((tmp_path / RESULTS).read_text().splitlines()) == len(done)


def test_a_unit_gives_the_same_result_again_and_its_sums_come_back(tmp_path: Path) -> None:
    play = SuiteRun(load_scenario("crossing_pair").lasting(1.0), 0)
    unit = TrackUnit(play, tmp_path, Setting("contour"), 1)
    one = unit.run()
    assert one == unit.run()
    restored_paper = restored(PaperMetrics, one["ignore"]["paper"])
    assert restored_paper.areas.targets == one["ignore"]["counts"]["targets"] > 0
    assert set(RECORDS) == set(one["absent"])


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
    trial = next(one for one in EXPERIMENTS.values() if isinstance(one, Tracking)).trials[0]
    keys = [{unit.key for unit in units_of(trial, plan, 1)} for plan in (few, all_of_them)]
    assert keys[0] == keys[1]


def test_a_quick_run_has_its_own_repeats(capsys: pytest.CaptureFixture[str]) -> None:
    assert "either it or --repeats" in refusal(capsys, "reproduce", "--quick", "--repeats", "2")


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


def test_sections_are_printed_with_both_figures_and_both_tests(capsys: pytest.CaptureFixture[str]) -> None:
    (position,) = choose(["panoramic-position"])
    print_sections([section(Outcome(position, made_up(position)))])
    told = capsys.readouterr().out
    for words in (
        "0.154 ± 0.094",
        "0.145 ± 0.092",
        "paired by stretches of time: t =",
        "unpaired: t =",
        "d_z =",
    ):
        assert words in told
