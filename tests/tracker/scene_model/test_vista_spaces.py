"""Places seen from several standing points, joined."""

from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.scene_model.vista_spaces import StaticMap, Surface, registered


def wall(start: tuple[float, float], end: tuple[float, float], rng: np.random.Generator) -> Surface:
    """An upright wall, seen with noise."""
    along = np.subtract(end, start)
    share, height = rng.uniform(size=1500), rng.uniform(0.1, 2.0, 1500)
    normal = np.array([-along[1], along[0]]) / np.hypot(*along)
    places = np.asarray(start) + share[:, None] * along + 0.01 * rng.standard_normal((1500, 1)) * normal
    return Surface(np.column_stack([places, height]), np.tile([*normal, 0.0], (1500, 1)))


def room(rng: np.random.Generator) -> Surface:
    one = wall((5.0, -2.0), (5.0, 3.0), rng).joined(wall((5.0, 3.0), (0.0, 3.0), rng))
    return one.joined(wall((3.0, -1.0), (4.0, -1.2), rng))


def seen_from(pose: Pose2, rng: np.random.Generator) -> Surface:
    whole = room(rng)
    return whole.seen_from(pose.inverse())


def test_registration_takes_out_what_odometry_got_wrong(rng: np.random.Generator) -> None:
    true = Pose2(x=1.0, y=-0.4, heading=0.3)
    wrong = Pose2(x=1.12, y=-0.3, heading=0.36)
    found = registered(seen_from(true, rng), room(rng), wrong)
    assert math.hypot(found.x - true.x, found.y - true.y) < 0.01
    assert found.heading == pytest.approx(true.heading, abs=0.005)


def test_along_a_single_wall_the_guess_stays_as_it_is(rng: np.random.Generator) -> None:
    known = wall((5.0, -4.0), (5.0, 4.0), rng)
    found = registered(known, known, Pose2(x=0.1, y=0.2))
    assert found.x == pytest.approx(0.0, abs=0.01)
    assert found.y == pytest.approx(0.2, abs=0.02)


def test_without_joining_odometry_is_believed(rng: np.random.Generator) -> None:
    both = StaticMap(joins=False)
    both.add(room(rng), Pose2())
    guess = Pose2(x=0.5, heading=0.1)
    assert both.add(room(rng), guess) == guess
