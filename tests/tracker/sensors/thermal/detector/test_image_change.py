"""What moves, told by the images before."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.sensors.thermal.detector.image_change import (
    Grey,
    PastImages,
    image_difference,
    rotation_homography,
)


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


ROWS, COLUMNS, FOCAL = 120, 160, 150.0


def speckled() -> NDArray[np.uint8]:
    rng = np.random.default_rng(0)
    return np.kron(rng.integers(0, 256, (ROWS // 4, COLUMNS // 4)), np.ones((4, 4))).astype(np.uint8)


def camera(pitch_down_rad: float) -> PinholeCalibration:
    c, s = math.cos(pitch_down_rad), math.sin(pitch_down_rad)
    robot_from_camera = np.eye(4)
    # x right is y of the robot, negative; z forward goes down by the pitch.
    robot_from_camera[:3, :3] = np.array([[0.0, -s, c], [-1.0, 0.0, 0.0], [0.0, -c, -s]])
    robot_from_camera[:3, 3] = 0.0, 0.0, 1.2
    middle = [[FOCAL, 0.0, (COLUMNS - 1) / 2], [0.0, FOCAL, (ROWS - 1) / 2], [0.0, 0.0, 1.0]]
    return PinholeCalibration(np.array(middle), robot_from_camera)


@pytest.mark.parametrize("pitch_rad", [0.0, 0.2, -0.3])
@pytest.mark.parametrize("turn_rad", [0.05, -0.1])
def test_a_turn_moves_pixels_as_the_calibration_says(pitch_rad: float, turn_rad: float) -> None:
    calibration = camera(pitch_rad)
    pixels = np.array([[10.0, 20.0], [80.0, 60.0], [150.0, 100.0]])
    c, s = math.cos(-turn_rad), math.sin(-turn_rad)
    about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    there = calibration.project(calibration.rays(pixels) @ about_z.T + calibration.position_m)
    moved = rotation_homography(mount_of(calibration, ROWS), (ROWS, COLUMNS), turn_rad)
    found = np.c_[pixels, np.ones(3)] @ moved.T
    np.testing.assert_allclose(found[:, :2] / found[:, 2:], there, atol=1e-3)


def test_a_turn_to_the_left_moves_pixels_to_the_right() -> None:
    moved = rotation_homography(mount_of(camera(0.0), ROWS), (ROWS, COLUMNS), 0.1)
    assert (moved @ [80.0, 60.0, 1.0])[0] > 80.0


def test_what_the_motion_of_the_camera_explains_is_no_change() -> None:
    before = speckled()
    moved = rotation_homography(mount_of(camera(0.0), ROWS), (ROWS, COLUMNS), 0.04)
    now = cv2.warpPerspective(before, moved, (COLUMNS, ROWS), borderMode=cv2.BORDER_REPLICATE)
    now = np.asarray(now, np.uint8)
    assert image_difference(before, now, np.eye(3)).mean() > 10.0
    assert not image_difference(before, now, moved).any()


def test_what_has_come_into_view_is_no_change() -> None:
    now = np.roll(speckled(), 12, axis=1)
    moved = np.array([[1.0, 0.0, 12.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    assert image_difference(speckled(), now, moved).mean() < 1.0


@pytest.mark.parametrize(
    ("turn_rad", "is_still"), [(1e-7, True), (-5e-5, True), (2e-4, False), (-0.01, False)]
)
def test_a_turn_by_less_than_pixels_are_told_apart_moves_nothing(turn_rad: float, is_still: bool) -> None:
    before, now = speckled(), speckled()[:, ::-1].copy()
    moved = rotation_homography(mount_of(camera(0.1), ROWS), (ROWS, COLUMNS), turn_rad)
    assert np.array_equal(image_difference(before, now, moved), cv2.absdiff(now, before)) == is_still
