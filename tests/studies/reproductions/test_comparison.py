from __future__ import annotations

import numpy as np
import pytest

from peopleboy.studies.reproductions.catalogue import EXPERIMENTS
from peopleboy.studies.reproductions.comparison import ClaimStatus, Standing, compare, judge
from peopleboy.studies.reproductions.experiment import Claim, Experiment, ExperimentOutcome, Line
from peopleboy.studies.reproductions.source_page import below_source, section
from tests.helpers.made_up_results import DRIVES, MadeUp, made_up
from tests.helpers.some_of import some_of
from tests.studies.reproductions.test_statistics import ONE, of_means


@pytest.mark.parametrize("number", EXPERIMENTS)
def test_figures_and_claims_of_the_source_meet_lines_and_columns_of_ours(number: str) -> None:
    experiment = EXPERIMENTS[number]
    samples = made_up(experiment)
    columns = {name for values in samples.values() for name in values}
    groups = {line.group for line in samples}
    for printed in experiment.values:
        assert printed.group in groups
        assert set(printed.values) <= columns
    for claim in experiment.claims:
        assert set(claim.groups) <= groups
        assert claim.metric in columns
        assert list(judge(claim, samples))


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
    part = section(ExperimentOutcome(EXPERIMENTS["figure-5.5a"], samples))
    found = [
        (number, one.group, one.method, one.standing.value) for number, one in below_source([part, part])
    ]
    assert found == [
        ("figure-5.5a", "1000", "default", "equal"),
        ("figure-5.5a", "1000", "default, strict", "worse"),
        ("figure-5.5a", "2000", "default, strict", "worse"),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    "number", some_of([one for one in EXPERIMENTS if one.startswith("situation-figure")], 4)
)
def test_figures_of_drives_are_drawn(number: str) -> None:
    found = ExperimentOutcome.of(EXPERIMENTS[number], DRIVES, MadeUp())
    assert str(found.picture).startswith("data:image/png;base64,")


@pytest.mark.slow
def test_goals_are_reached_or_not_by_what_was_measured() -> None:
    samples = made_up(EXPERIMENTS["situation-goals"])
    figures = {line.group: values["figure"].tolist() for line, values in samples.items()}
    assert figures["rate"] == figures["rate of the worst set"] == [0.75]
    assert figures["error, mean [m]"] == pytest.approx([0.1])
    assert figures["false sizes per image"] == pytest.approx([1.0 / 3.0])
    assert figures["switches a run in turns, saved by odometry"] == [0.0]


@pytest.mark.parametrize(
    ("column", "ours", "standing"),
    [
        ("AA", [60.5, 60.1, 60.3], Standing.ALIKE),
        ("AA", [70.5, 70.1, 70.3], Standing.BETTER),
        ("AA", [50.5, 50.1, 50.3], Standing.WORSE),
        ("AA", [50.5, 70.1, 62.3], Standing.UNCLEAR),
        ("AA", [70.0], Standing.UNCLEAR),
        ("AA", [np.nan, 1.0], Standing.UNKNOWN),
        ("s", [20.0, 20.1, 20.2], Standing.BETTER),
    ],
)
def test_a_figure_stands_where_its_interval_puts_it(
    column: str, ours: list[float], standing: Standing
) -> None:
    table = Experiment.model_validate(
        {"id": "x", "title": "t", "source": "s", "values": [{"group": "a", "ms": 3, column: 60.0}]}
    )
    samples = {Line("a", "default"): {column: np.array(ours), "ms": np.array([1.0])}}
    (found,) = compare(samples, table)
    assert (found.column, found.method, found.standing) == (column, "default", standing)


def test_a_figure_of_one_repeat_stands_where_its_films_put_it() -> None:
    samples = {
        Line("1000", "default"): {"AA": of_means(ONE)},
        Line("2000", "default"): {"AA": of_means(ONE - 5.5)},
    }
    found = {one.group: one.standing for one in compare(samples, EXPERIMENTS["figure-5.5a"])}
    assert found == {"1000": Standing.BETTER, "2000": Standing.ALIKE}
