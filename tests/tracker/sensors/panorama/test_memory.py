import math

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.networks.mask_network import BLOCK
from peopleboy.tracker.sensors.panorama.background_memory import (
    AGE,
    DOUBT,
    compare,
    first_memory,
    learn,
    move_along,
)
from peopleboy.tracker.sensors.panorama.floor_rows import floor_rows
from tests.helpers.images.as_taken import as_taken

CAMERA = PanoramaCalibration(
    width=480,
    height=120,
    focal_px=111.9,
    axis_rad=math.radians(55),
    ring_radius_m=-0.023,
    ring_height_m=1.713,
)
FLOOR = floor_rows(CAMERA, 120)


def floor_image(x, y, heading, period_m=1.5):
    """What a robot at a pose sees of a floor whose brightness is a smooth function of the place."""
    bearing = CAMERA.bearing(np.arange(480.0)) + heading
    east = x + FLOOR.distance_m[:, None] * np.cos(bearing)
    north = y + FLOOR.distance_m[:, None] * np.sin(bearing)
    grey = 120 + 50 * np.sin(2 * np.pi * east / period_m) * np.cos(2 * np.pi * north / period_m)
    return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=2)


def test_rows_of_the_floor_are_those_that_the_calibration_projects_it_to():
    distances = np.array([1.5, 2.0, 3.7, 6.0])
    rows = CAMERA.project(np.stack([distances, 0 * distances, 0 * distances], axis=1))[:, 1]
    assert np.interp(rows, np.arange(120), FLOOR.distance_m) == pytest.approx(distances, abs=0.02)


@pytest.mark.parametrize("columns", [1, 7, -30])
def test_turning_by_whole_columns_shifts_the_memory_by_them(columns):
    memory = first_memory(floor_image(0, 0, 0))
    turned = move_along(memory, Odometry(turn_rad=columns * math.tau / 480), FLOOR)
    np.testing.assert_allclose(turned, np.roll(memory, columns, axis=2), atol=0.05)


@pytest.mark.parametrize("pose", [(0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.08, -0.05, 0.2), (0.3, 0.0, -0.1)])
def test_floor_lies_where_it_is_seen_after_a_movement(pose):
    memory = first_memory(floor_image(0, 0, 0))
    moved = move_along(memory, Odometry(advance_m=pose[0], aside_m=pose[1], turn_rad=pose[2]), FLOOR)
    off = np.abs(moved[0] - floor_image(*pose)[..., 0])[20:110]  # rows from 1.3 to 7 m
    assert off.mean() < 1.5
    assert np.abs(memory[0].astype(float) - floor_image(*pose)[..., 0])[20:110].mean() > 5 * off.mean()


def test_what_was_below_the_image_before_is_new():
    memory = first_memory(floor_image(0, 0, 0))
    memory[AGE] = 5.0
    moved = move_along(memory, Odometry(advance_m=-0.3), FLOOR)  # uncovers floor in front
    assert moved[AGE, 119, 240] == 0.0
    assert moved[AGE, 60, 240] == pytest.approx(5.0)


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", [3, 15])
def test_an_empty_scene_is_known_within_seconds_whatever_the_rate_of_images(rate_hz):
    rng, scene = np.random.default_rng(0), floor_image(0, 0, 0).astype(float)
    memory, nobody = first_memory(np.full((120, 480, 3), 90, np.uint8)), np.zeros((120, 480), np.float32)
    for _ in range(12 * rate_hz):
        noisy = np.clip(np.rint(scene + rng.normal(0, 3, scene.shape)), 0, 255).astype(np.uint8)
        learn(memory, as_taken(noisy), nobody, 1 / rate_hz)
    assert np.abs(memory[:3] - scene.transpose(2, 0, 1)).mean() < 5
    assert memory[AGE] == pytest.approx(12, rel=0.01)


def test_what_people_hide_stays_and_is_absorbed_only_within_a_minute():
    memory, someone = first_memory(np.full((120, 480, 3), 90, np.uint8)), np.ones((120, 480), np.float32)
    memory[AGE] = 10.0
    red = np.zeros((120, 480, 3), np.uint8)
    red[..., 0] = 200
    for _ in range(15):
        learn(memory, as_taken(red), someone, 0.2)
    assert memory[0, 0, 0] < 110
    for _ in range(600):
        learn(memory, as_taken(red), someone, 0.2)
    assert memory[0, 0, 0] > 190


def test_unlikeness_is_in_standard_deviations():
    image = np.full((120, 480, 3), 100, np.uint8)
    memory = first_memory(image)
    memory[3] = 25.0
    image[50, 100] = 100 + 15  # three of them
    unlike = compare(as_taken(image), memory)[0].reshape(BLOCK, BLOCK, 6, 30, 120)[:, :, 3]
    assert unlike[50 % 4, 0, 50 // 4, 25] == pytest.approx(math.log(1 + 9) / 2, rel=1e-4)
    assert np.count_nonzero(unlike) == 1


def novelty_of(off_sd, age_s=1e9):
    """How new one pixel is that differs by so many standard deviations in each colour."""
    image = np.full((120, 480, 3), 100, np.uint8)
    memory = first_memory(image)
    memory[3], memory[AGE] = 25.0, age_s
    image[50, 101] = 100 + round(5 * off_sd)
    _, reported = compare(as_taken(image), memory)
    assert reported.shape == (120, 480)
    assert np.count_nonzero(reported) <= 1
    return float(reported[50, 101])


def test_new_is_what_differs_by_more_than_two_standard_deviations_and_wholly_from_eight_on():
    assert novelty_of(1.8) == 0.0
    assert 0.0 < novelty_of(3.0) < novelty_of(5.0) < novelty_of(7.0) < 1.0
    assert novelty_of(8.4) == pytest.approx(1.0)
    assert novelty_of(20.0) == pytest.approx(1.0)


def test_against_a_young_background_less_is_new():
    assert novelty_of(20.0, age_s=0.0) == 0.0
    assert novelty_of(20.0, age_s=1.0) == pytest.approx(0.5)


def test_before_a_patterned_floor_somebody_is_as_new_after_a_drive_as_before():
    floor = floor_image(0, 0, 0)
    memory = first_memory(floor)
    memory[AGE] = 60.0
    someone = floor.copy()
    someone[20:80, 200:220] += 40
    reported = {}
    for doubt_px in (0.0, 25.0):
        memory[DOUBT] = doubt_px
        _, reported[doubt_px] = compare(as_taken(someone), memory)
    assert np.array_equal(reported[0.0], reported[25.0])
    assert (reported[25.0][20:80, 200:220] > 0.5).mean() > 0.99
    assert np.count_nonzero(reported[25.0]) == np.count_nonzero(reported[25.0][20:80, 200:220])
