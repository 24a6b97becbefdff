import json
import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from peopleboy.scenarios.scores.bootstrap import bootstrap
from peopleboy.scenarios.scores.tables.drive_comparison import DriveComparison, _limit
from peopleboy.scenarios.scores.tables.show_scores import print_comparison

NAN = math.nan


@given(st.lists(st.floats(-1e3, 1e3) | st.just(NAN), min_size=1, max_size=20))
def test_the_interval_holds_the_mean_and_lies_within_the_values(values):
    found = bootstrap(values, np.random.default_rng(0))
    known = [value for value in values if not math.isnan(value)]
    if not known:
        assert math.isnan(found.mean)
        return
    if len(known) == 1:
        assert found.to_json() == [known[0], None, None]
        return
    assert min(known) - 1e-6 <= found.low <= found.high <= max(known) + 1e-6
    assert found.mean == pytest.approx(np.mean(known))


def test_the_interval_of_many_normal_values_is_that_of_the_standard_error():
    values = np.random.default_rng(1).normal(5.0, 2.0, 400)
    found = bootstrap(values.tolist(), np.random.default_rng(0))
    assert (found.high - found.low) / 2.0 == pytest.approx(1.96 * values.std() / 20.0, rel=0.1)


def test_a_comparison_is_printed_drawn_and_kept(tmp_path, capsys):
    runs = {
        "a@truth": [{"followed": 0.5, "jerk_m_s3": 1.0}, {"followed": 1.0, "jerk_m_s3": NAN}],
        "b@truth": [{"lateral_rms_m": 0.1, "personal_s": 2.0}] * 2,
    }
    found = DriveComparison("scene", runs)
    found.save(tmp_path)
    print_comparison(found)
    lines = {re.split(r"  +", line)[0]: line for line in capsys.readouterr().out.splitlines()}
    assert "75.00 % [50.00, 100.00]" in lines["followed"]
    assert "2.00 s [2.00, 2.00]" in lines["within 1.2 m"]
    content = json.loads((tmp_path / "comparison.json").read_text())
    assert content == found.to_json()
    (apart,) = content["differences"]
    assert (apart["controller"], apart["from"]) == ("b@truth", "a@truth")
    assert set(apart["p"].values()) == {None}  # the two share no metric
    kept = content["controllers"]
    assert kept["b@truth"]["mean"]["lateral_rms_m"] == pytest.approx([0.1] * 3)
    assert kept["a@truth"]["runs"][1]["jerk_m_s3"] is None
    assert (tmp_path / "comparison.png").stat().st_size > 5000
    assert set(found.means["a@truth"]) == {"followed", "jerk_m_s3"}


def test_controllers_are_compared_run_by_run():
    one = [{"followed": value} for value in (0.5, 0.6, 0.4, 0.7)]
    other = [{"followed": value} for value in (0.6, 0.7, 0.5, 0.8)]
    (differences,) = DriveComparison("scene", {"a": one, "b": other}).differences.values()
    apart = differences["followed"]
    assert apart.interval.mean == pytest.approx(0.1)
    assert apart.p == pytest.approx(2 / 2**4)


@pytest.mark.parametrize(
    ("values", "limits"), [([4.0, 4.0], (-0.2, 4.6)), ([0.0], (-0.05, 1.15)), ([-2.0], (-2.3, 0.1))]
)
def test_a_figure_that_is_the_same_in_all_runs_is_shown_beside_nought(values, limits):
    axes = Figure().subplots()
    _limit(axes, values)
    assert axes.get_xlim() == pytest.approx(limits)


def test_a_figure_that_no_run_defines_is_said_to_be_so():
    axes = Figure().subplots()
    _limit(axes, [math.nan, math.nan])
    assert [text.get_text() for text in axes.texts] == ["not defined in any run"]
