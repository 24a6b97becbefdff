"""A single repeat has intervals over its films, by the jackknife."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import ttest_ind, ttest_rel

from docs.generate.sources.source_run import SourceRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiments.catalogue import EXPERIMENTS
from peopleboy.studies.reproductions.experiments.experiment import FilmFigure, Line, Outcome
from peopleboy.studies.reproductions.experiments.tracking import Tracking, units_of
from peopleboy.studies.reproductions.measuring.units import RECORDS
from peopleboy.studies.reproductions.measuring.workload import full_plan
from peopleboy.studies.reproductions.showing.beside_source import Standing, compare
from peopleboy.studies.reproductions.showing.intervals import paired, to_source
from peopleboy.studies.reproductions.showing.source import source_tables
from peopleboy.studies.reproductions.showing.source_page import PageHead, page_text, section

ONE, OTHER = np.array([72.1, 70.4, 71.9, 73.0, 71.2]), np.array([70.0, 70.1, 70.3, 71.9, 70.8])
SWEEP = EXPERIMENTS["figure-4.9a"]


def of_means(values: NDArray[np.float64], films: str = "dataset1") -> FilmFigure:
    """Give the mean of films that weigh the same, and those without each of them."""
    without = (values.sum() - values) / (len(values) - 1)
    return FilmFigure(float(values.mean()), without, (films,))


def test_of_a_mean_the_jackknife_gives_back_what_it_is_of() -> None:
    np.testing.assert_allclose(of_means(ONE).by_film, ONE)


def test_the_same_films_are_compared_one_by_one_and_others_as_two_samples() -> None:
    same, apart = (
        paired("AA", of_means(ONE), of_means(OTHER)),
        paired("AA", of_means(ONE), of_means(OTHER, "b")),
    )
    student = ttest_rel(ONE, OTHER).confidence_interval(0.95)
    welch = ttest_ind(ONE, OTHER, equal_var=False).confidence_interval(0.95)
    assert (same.low, same.high) == pytest.approx((student.low, student.high))
    assert (apart.low, apart.high) == pytest.approx((welch.low, welch.high))


def test_a_printed_figure_is_compared_with_all_films() -> None:
    found = to_source("AA", of_means(ONE), 70.0, None)
    student = ttest_rel(ONE, np.full(5, 70.0)).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((student.low, student.high))


def test_one_film_against_several_has_no_interval() -> None:
    assert not paired("AA", of_means(ONE), np.array([70.0])).is_sure


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
        assert isinstance(SWEEP, Tracking)
        for trial in SWEEP.trials:
            for number, unit in enumerate(units_of(trial, plan, 0)):
                result = {name: nothing(kind) for name, kind in RECORDS.items()}
                result["thesis"]["matches"] = 90 - number
                result["thesis"]["areas"] |= {"targets": 100, "candidates": 90 - number}
                self[unit.key] = {trial.rule: result}


def test_a_sweep_of_one_repeat_keeps_what_each_film_does_through_the_shipped_run(tmp_path: Path) -> None:
    samples = SWEEP.samples(full_plan(Path("films"), 1), Seen())
    found = samples[Line("100", "default")]["CR"]
    assert isinstance(found, FilmFigure)
    np.testing.assert_allclose(found.by_film, 90.0 - np.arange(10))
    outcome = Outcome(SWEEP, samples)
    assert (outcome.repeats, outcome.films) == (1, 10)
    head = PageHead(command="peopleboy reproduce", is_quick=False, amount="All.", facts={})
    SourceRun(head, (outcome,)).write(tmp_path)
    (back,) = SourceRun.read(tmp_path).outcomes
    again = back.samples[Line("100", "default")]["CR"]
    assert isinstance(again, FilmFigure)
    np.testing.assert_allclose(again.by_film, found.by_film, atol=1e-3)
    assert "1 repeat, intervals over 10 films" in page_text([section(back)], head)


def test_a_figure_of_one_repeat_stands_where_its_films_put_it() -> None:
    samples = {
        Line("1000", "default"): {"AA": of_means(ONE)},
        Line("2000", "default"): {"AA": of_means(ONE - 5.5)},
    }
    found = {one.group: one.standing for one in compare(samples, source_tables()["figure-5.5a"])}
    assert found == {"1000": Standing.BETTER, "2000": Standing.ALIKE}
