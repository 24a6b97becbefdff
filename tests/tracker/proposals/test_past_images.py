"""What moves, told by the images before."""

from __future__ import annotations

import numpy as np

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.proposals.motion import Grey
from peopleboy.tracker.proposals.past_images import PastImages


def plain(value: int) -> Grey:
    return np.full((120, 160), value, np.uint8)


def test_the_image_of_about_a_fifth_of_a_second_ago_tells_what_moves() -> None:
    images, changes = PastImages(), []
    for k in range(8):
        images.keep(plain(10 * k), k / 15.0, Odometry())
        changes.append(images.change(Mount(59.5, 150.0, 1.2)).max())
    assert changes == [0, 10, 20, 30, 30, 30, 30, 30]


def test_what_is_older_than_twice_that_tells_nothing() -> None:
    images = PastImages()
    images.keep(plain(0), 0.0)
    images.keep(plain(90), 1.0)
    assert not images.change().any()


def test_time_that_goes_back_and_an_image_of_another_size_begin_anew() -> None:
    images = PastImages()
    for k in range(3):
        images.keep(plain(0), 5.0 + k / 15.0)
    images.keep(plain(90), 0.0)
    assert not images.change().any()
    images.keep(np.full((60, 80), 90, np.uint8), 0.1)
    assert not images.change().any()


def test_the_turn_of_a_robot_with_odometry_is_no_motion() -> None:
    rng, mount = np.random.default_rng(0), Mount(59.5, 150.0, 1.2)
    wide = np.kron(rng.integers(0, 256, (30, 60)), np.ones((4, 4))).astype(np.uint8)
    step = Odometry(turn_rad=4.0 / 150.0)  # 4 px in the middle of the image
    known, still = PastImages(), PastImages()
    for k in range(4):
        start = 40 - 4 * k
        known.keep(wide[:, start : start + 160], k / 15.0, step)
        still.keep(wide[:, start : start + 160], k / 15.0, Odometry())
    change, other = known.change(mount), still.change(mount)
    assert change[20:100, 40:120].mean() < 0.5 * other[20:100, 40:120].mean()
