from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.reproductions.tracker_settings import BASES
from peopleboy.studies.reproductions.tune import (
    PARAMETERS,
    RESULTS,
    TrainingFilms,
    Tuned,
    chosen_parameters,
    tune,
)
from peopleboy.tracker.reproductions.contour.measurement.contour import section_weights
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import refused

RHO = PARAMETERS["rho"]


def tuned(**accuracy: list[float]) -> Tuned:
    """Say what the values of rho came to; `v5` is 5."""
    return Tuned(RHO, {value[1:]: np.array(figures) for value, figures in accuracy.items()})


def test_every_parameter_of_the_thesis_is_there_with_its_printed_value_among_others() -> None:
    assert list(PARAMETERS) == [
        "alpha", "kappa", "theta", "U", "B", "psi_D", "rho", "lambda", "n_k", "rho_o",
    ]  # fmt: skip
    for one in PARAMETERS.values():
        assert one.values[one.printed] == ()
        assert len(one.values) >= 5


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_value_makes_another_tracker_but_the_printed_one(name: str) -> None:
    one = PARAMETERS[name]
    configs = [one.setting(value).config() for value in one.values]
    assert all(configs.count(config) == 1 for config in configs)
    assert one.setting(one.printed).config() == BASES[one.base]


def test_values_are_scaled_to_the_settings_units() -> None:
    printed, double = (PARAMETERS["kappa"].setting(v).config().likelihood.slope for v in ("0.125", "0.25"))
    assert double == pytest.approx(2 * printed)
    config = PARAMETERS["B"].setting("2").config().motion
    assert (config.noise_x, config.noise_d) == pytest.approx((30.0, 120.0))


def test_weights_of_sections_add_up_to_one_whatever_the_shoulders_count() -> None:
    for value in PARAMETERS["alpha"].values:
        weights = section_weights(PARAMETERS["alpha"].setting(value).config().contour)
        assert weights.sum() == pytest.approx(1.0)
        assert weights[3] / weights[0] == pytest.approx(float(value) / 0.18)


@pytest.mark.parametrize(
    ("one", "best", "verdict"),
    [
        (tuned(v2=[60, 61, 62], v5=[50, 51, 52]), "2", "no other value is better"),
        (tuned(v2=[60, 61, 62], v5=[60, 61, 62]), "2", "no other value is better"),
        (tuned(v2=[50, 51, 52], v5=[60, 61.2, 62]), "5", "5 is better"),
        (tuned(v2=[60, 61, 62], v5=[60.1, 61, 62]), "5", "little effect"),
        (tuned(v2=[50, 60, 70], v5=[70, 55, 62]), "5", "undecided"),
        (tuned(v2=[50], v5=[70]), "5", "undecided"),
    ],
)
def test_only_an_interval_makes_another_value_better(one: Tuned, best: str, verdict: str) -> None:
    assert (one.best, one.verdict) == (best, verdict)


@pytest.mark.slow
def test_curves_and_a_page_are_left_and_what_is_done_is_not_done_again(tmp_path: Path) -> None:
    films = TrainingFilms(cache=tmp_path / "films", seeds=range(100, 101), seconds=1.5)
    page, (found,) = tune([RHO], films, tmp_path / "out", Workers())
    assert set(found.accuracy) == set(RHO.values)
    assert "rho.svg" in page.read_text()
    assert json.loads((page.parent / "tuned.json").read_text())["rho"]["printed"] == 2.0
    curve, done = (page.parent / "rho.svg").read_bytes(), (page.parent / RESULTS).read_text()
    assert tune([RHO], films, tmp_path / "out", Workers())[0] == page
    assert (page.parent / "rho.svg").read_bytes() == curve
    assert (page.parent / RESULTS).read_text() == done
    keys = [json.loads(line)["key"] for line in done.splitlines()]
    assert all("hall_visits-100" in key for key in keys)


def test_an_unknown_parameter_is_refused_with_all_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    with refused("sigma", *PARAMETERS):
        chosen_parameters(["rho", "sigma"])
    assert "kappa" in refusal(capsys, "tune", "--parameter", "sigma")
    assert chosen_parameters(["rho", "alpha"]) == [PARAMETERS["alpha"], RHO]
