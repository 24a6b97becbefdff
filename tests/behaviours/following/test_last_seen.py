"""Where the robot goes when it saw somebody last, and where it stops."""

import math

import numpy as np
import pytest

from peopleboy.behaviours.following.last_seen import LastPlace, PlaceConfig, end_of_way

AWAY = LastPlace(x_m=3.0, y_m=0.0)
CONFIG = PlaceConfig()


def wall(start: tuple[float, float], end: tuple[float, float]) -> np.ndarray:
    """Points every 5 cm on a wall."""
    count = 1 + math.ceil(math.dist(start, end) / 0.05)
    return np.linspace(start, end, count)


def door(ahead_m: float, width_m: float) -> np.ndarray:
    half = width_m / 2.0
    return np.concatenate(
        [wall((ahead_m, half), (ahead_m, half + 2.0)), wall((ahead_m, -half), (ahead_m, -half - 2.0))]
    )


def corridor(width_m: float, heading_rad: float) -> np.ndarray:
    """Both walls, seen by a robot in the middle that heads so far to the left of the corridor's way."""
    sides = np.concatenate([wall((-1.0, y), (4.0, y)) for y in (width_m / 2.0, -width_m / 2.0)])
    cos, sin = math.cos(heading_rad), math.sin(heading_rad)
    return sides @ np.array([[cos, -sin], [sin, cos]])


def test_the_robot_does_not_enter_a_door_after_somebody_it_cannot_see() -> None:
    assert "too narrow" in end_of_way(AWAY, door(0.6, 0.9), CONFIG)
    assert "too narrow" in end_of_way(AWAY, door(0.6, 1.2), CONFIG)
    assert end_of_way(AWAY, door(2.0, 1.2), CONFIG) == ""
    assert end_of_way(AWAY, door(0.6, 1.4), CONFIG) == ""


@pytest.mark.parametrize("heading_deg", [-30, -10, 0, 20, 30])
def test_a_corridor_is_wide_enough_under_any_heading_along_it(heading_deg: float) -> None:
    assert end_of_way(AWAY, corridor(2.0, math.radians(heading_deg)), CONFIG) == ""


def test_a_wall_across_the_way_is_no_passage() -> None:
    assert end_of_way(AWAY, wall((0.7, -2.0), (0.7, 2.0)), CONFIG) == ""


def test_the_way_ends_where_the_person_was() -> None:
    assert "no person" in end_of_way(LastPlace(x_m=0.3, y_m=0.2), np.zeros((0, 2)), CONFIG)
    blocked = LastPlace(x_m=3.0, y_m=0.0, blocked_s=CONFIG.blocked_s + 0.1)
    assert "blocked" in end_of_way(blocked, np.zeros((0, 2)), CONFIG)
