import math
from types import SimpleNamespace

import pytest

from benchmarks.reliability.faults import COLUMNS, FAULTS, FROM_S, LASTS_S, FaultRun, run_with, summarise
from benchmarks.reliability.safety import KINDS, Stop
from peopleboy.scenarios.files.load import load_scenario


def found(followed, recovered_s, after_s, speed_m_s=0.6):
    """Results without a tracker's scores."""
    following = SimpleNamespace(followed=followed, mean_distance_error_m=0.5)
    stop = Stop(speed_m_s, after_s, 0.1)
    return FaultRun(people=None, following=following, contacts=1, stop=stop, recovered_s=recovered_s)


def test_every_kind_of_fault_is_measured():
    assert set(KINDS) < set(FAULTS)
    assert next(iter(FAULTS)) == "none"


def test_only_a_robot_that_drives_can_stop(monkeypatch):
    scores = SimpleNamespace(mot=SimpleNamespace(hota=SimpleNamespace(hota=80.0)))
    monkeypatch.setattr("benchmarks.reliability.faults.combine", lambda _: scores)
    runs = [found(0.5, 0.2, 0.3), found(0.7, math.nan, math.nan), found(0.9, 0.4, 0.0, speed_m_s=0.0)]
    row = summarise(runs, [found(1.0, 0.0, math.nan)])
    assert list(row) == list(COLUMNS)
    assert row["tracked"] == pytest.approx(70.0)
    assert (row["stops"], row["median stop"], row["latest stop"]) == (50.0, 0.3, 0.3)
    assert row["recover"] == pytest.approx(200.0 / 3.0)
    assert row["median recovery"] == pytest.approx(0.3)
    assert (row["change"], row["contacts"]) == (0.0, 3)
    assert summarise(runs, runs)["change"] is None


@pytest.mark.slow
def test_a_lost_camera_stops_the_robot_which_recovers():
    scenario = load_scenario("follow_round_corner").lasting(FROM_S + LASTS_S + 1.0)
    run = run_with("camera_lost", scenario, 0, "truth")
    assert run.stop.speed_m_s > 0.4
    assert run.stop.after_s < 0.31
    assert run.recovered_s < 0.5
    assert run.contacts == 0
