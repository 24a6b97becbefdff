from __future__ import annotations

import numpy as np
import pytest

from peopleboy.studies.reproductions.experiments.leg_tracker import LegTracker, find_people
from peopleboy.tracker.frame import Floats, Odometry


def scene(*legs: tuple[float, float]) -> Floats:
    """Scan round legs of 6 cm radius before a wall 6 m ahead, by rays from the robot."""
    angles = np.radians(np.linspace(60.0, -60.0, 481))
    reach = 6.0 / np.cos(angles)
    for x, y in legs:
        along = x * np.cos(angles) + y * np.sin(angles)
        aside = x * np.sin(angles) - y * np.cos(angles)
        hit = (np.abs(aside) < 0.06) & (along > 0.0)
        near = along - np.sqrt(np.maximum(0.06**2 - aside**2, 0.0))
        reach = np.where(hit, np.minimum(reach, near), reach)
    return np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)


def test_a_pair_of_legs_is_one_person_and_a_wall_is_nobody() -> None:
    (place,) = find_people(scene((2.0, 0.15), (2.1, -0.15)))
    assert place == pytest.approx((2.05, 0.0), abs=0.08)
    assert find_people(scene()) == []


def test_a_single_leg_is_somebody_and_one_too_far_away_is_not() -> None:
    assert len(find_people(scene((2.0, 0.0)))) == 1
    assert find_people(scene((5.5, 0.0))) == []


def test_legs_far_apart_are_two_people() -> None:
    assert len(find_people(scene((2.0, 0.8), (2.0, -0.8)))) == 2


def test_whoever_is_seen_often_enough_keeps_a_number_while_the_robot_turns() -> None:
    tracker, turn = LegTracker(), np.radians(15.0)
    told = [tracker.update(scene((3.0, 0.0)), None) for _ in range(5)]
    assert [len(tracks) for tracks in told] == [0, 0, 0, 1, 1]
    turned = (3.0 * np.cos(turn), -3.0 * np.sin(turn))  # 0.8 m off without odometry
    (after,) = tracker.update(scene(turned), Odometry(advance_m=0.0, aside_m=0.0, turn_rad=float(turn)))
    assert after.id == told[-1][0].id
