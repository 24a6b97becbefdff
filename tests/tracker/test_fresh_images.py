"""Which images are new, and how the robot moved since."""

from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.tracker.frame import Frame, FreshImages, Odometry, joined


def frame(k: int, image: int | None, odometry: Odometry | None = None) -> Frame:
    images = {} if image is None else {"eye": np.full((2, 2), image, np.uint8)}
    return Frame(images=images, time_s=float(k), odometry=odometry)


def test_an_image_that_stands_still_or_is_missing_is_no_new_one() -> None:
    eye = FreshImages("eye")
    seen = [eye.of(frame(k, image)) is not None for k, image in enumerate([1, 1, None, 2, 2, 1])]
    assert seen == [True, False, False, True, False, True]


def test_odometry_counts_from_the_last_image_on() -> None:
    eye = FreshImages("eye")
    eye.of(frame(0, 1, Odometry()))
    turn = Odometry(advance_m=1.0, turn_rad=math.pi / 2)
    assert eye.of(frame(1, None, turn)) is None
    fresh = eye.of(frame(2, 2, turn))
    assert fresh is not None
    assert fresh.odometry is not None
    assert fresh.odometry.advance_m == pytest.approx(1.0)
    assert fresh.odometry.aside_m == pytest.approx(1.0)
    assert abs(fresh.odometry.turn_rad) == pytest.approx(math.pi)


def test_a_step_alone_stays_as_it_is_and_an_unknown_one_makes_all_unknown() -> None:
    step = Odometry(advance_m=0.037, aside_m=-0.001, turn_rad=0.1)
    assert joined(Odometry(), step) == step
    assert joined(step, None) is None
    assert joined(None, step) is None
