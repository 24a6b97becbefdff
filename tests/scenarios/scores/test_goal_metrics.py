import math

import numpy as np
import pytest

from peopleboy.scenarios.scores.goal_metrics import REACHED_M, GoalTask, score_goal
from tests.helpers.drives import made_drive


def score(x, shortest_m=8.0):
    robot = np.stack([x, np.zeros(len(x)), np.zeros(len(x))], axis=1)
    return score_goal(made_drive(np.arange(len(x)) / 2.0, robot), GoalTask((8.0, 0.0), shortest_m))


def test_the_straight_path_to_the_goal_has_full_spl_and_what_follows_does_not_count() -> None:
    there = np.arange(0.0, 8.1, 0.25)
    for x in (there, np.concatenate([there, there[::-1]])):
        found = score(x)
        assert found.reached
        assert found.spl == pytest.approx(1.0, abs=0.04)
        assert found.time_s == pytest.approx(15.5)  # the first instant within 0.5 m
        assert found.path_m == pytest.approx(7.75)


def test_a_detour_lowers_spl_in_proportion() -> None:
    detour = np.concatenate(
        [np.arange(0.0, 4.0, 0.25), np.arange(4.0, 0.0, -0.25), np.arange(0.0, 8.1, 0.25)]
    )
    assert score(detour).spl == pytest.approx((8.0 - REACHED_M) / (2 * 4.0 + 7.75))


def test_a_goal_that_is_not_reached_scores_nothing_but_the_nearest_distance() -> None:
    found = score(np.arange(0.0, 7.1, 0.25))
    assert (found.reached, found.spl, found.nearest_m) == (False, 0.0, pytest.approx(1.0))
    assert math.isnan(found.time_s)
