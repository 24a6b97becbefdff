"""Places seen from several standing points, joined."""

from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.tracker.frame import Floats, Odometry
from peopleboy.tracker.scene_model.vista_spaces import Pose, StaticMap, Surface, registered


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


def inverse(pose: Pose, points: Floats) -> Floats:
    cosine, sine = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray((points - (pose.x_m, pose.y_m, 0.0)) @ turn.T)


def seen_from(pose: Pose, rng: np.random.Generator) -> Surface:
    whole = room(rng)
    return Surface(inverse(pose, whole.points_m), inverse(Pose(heading_rad=pose.heading_rad), whole.normals))


def test_registration_takes_out_what_odometry_got_wrong(rng: np.random.Generator) -> None:
    true = Pose(x_m=1.0, y_m=-0.4, heading_rad=0.3)
    wrong = Pose(x_m=1.12, y_m=-0.3, heading_rad=0.36)
    found = registered(seen_from(true, rng), room(rng), wrong)
    assert math.hypot(found.x_m - true.x_m, found.y_m - true.y_m) < 0.01
    assert found.heading_rad == pytest.approx(true.heading_rad, abs=0.005)


def test_along_a_single_wall_the_guess_stays_as_it_is(rng: np.random.Generator) -> None:
    known = wall((5.0, -4.0), (5.0, 4.0), rng)
    found = registered(known, known, Pose(x_m=0.1, y_m=0.2))
    assert found.x_m == pytest.approx(0.0, abs=0.01)
    assert found.y_m == pytest.approx(0.2, abs=0.02)


def test_without_joining_odometry_is_believed(rng: np.random.Generator) -> None:
    both = StaticMap(joins=False)
    both.add(room(rng), Pose())
    guess = Pose(x_m=0.5, heading_rad=0.1)
    assert both.add(room(rng), guess) == guess


def test_ways_add_up_in_the_robots_own_frame() -> None:
    pose = Pose()
    for _ in range(4):
        pose = pose.moved(Odometry(advance_m=1.0, turn_rad=math.pi / 2))
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
