"""Walls as planes: found in closed form, and left out so that who walks beside one is apart."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.depth.pre_detection import HumanSize, PreDetector
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from peopleboy.tracker.sensors.depth.walls import bands_mm, find_walls, without
from tests.helpers.depth_scene import FOCAL_PX, HEIGHT, WIDTH, depth_of, make_view
from tests.helpers.images.as_taken import as_taken

ABOVE = UDepthConfig()
DETECT, LEFT_IN = (PreDetector(HumanSize(), replace(ABOVE, has_walls=walls)) for walls in (True, False))
VIEW = make_view()
ACROSS = np.tile((np.arange(WIDTH) - (WIDTH - 1) / 2) / FOCAL_PX, (HEIGHT, 1))
DOWN = np.tile((np.arange(HEIGHT)[:, None] - (HEIGHT - 1) / 2) / FOCAL_PX, WIDTH)


def oblique_wall(deg: float, away_m: float) -> np.ndarray:
    """Depth (H, W) [m] of a plane so far from the camera, whose normal points so far to the right of it."""
    towards = ACROSS * math.sin(math.radians(deg)) + math.cos(math.radians(deg))
    return np.where(towards > 0, away_m / np.maximum(towards, 1e-6), np.inf)


def box_before_wall(deg: float, away_m: float, before_m: float) -> np.ndarray:
    """Depth (H, W) [m] of a box straight ahead, infinite elsewhere.

    It is 0.5 m wide along a wall as above, 0.3 m deep and 1.7 m tall; its middle is so far before the wall.
    """
    sin, cos = math.sin(math.radians(deg)), math.cos(math.radians(deg))
    towards, along = ACROSS * sin + cos, ACROSS * cos - sin
    middle = away_m - before_m
    nearest, farthest = [], []
    for way, at, half in ((towards, middle, 0.15), (along, -middle * sin / cos, 0.25)):
        sides = np.sort([(at - half) / way, (at + half) / way], axis=0)
        nearest.append(sides[0])
        farthest.append(sides[1])
    entry = np.maximum(*nearest)
    is_in = (entry <= np.minimum(*farthest)) & (DOWN * entry >= 1.2 - 1.7) & (DOWN * entry <= 1.2)
    return np.where(is_in, entry, np.inf)


def room_with(*surfaces: np.ndarray) -> np.ndarray:
    """Depth image (H, W) [mm] of floor, ceiling and surfaces."""
    room = depth_of(wall_m=60.0).astype(float)
    return as_taken(
        np.round(np.minimum.reduce([room, *(1000.0 * one for one in surfaces)])).astype(np.uint16)
    )


@pytest.mark.parametrize("deg", [-45.0, -40.0, 40.0, 45.0])
def test_a_box_30_cm_before_a_wall_is_a_piece_of_its_own(deg: float) -> None:
    away_m = 4.0
    depth = room_with(oblique_wall(deg, away_m), box_before_wall(deg, away_m, 0.3))
    assert LEFT_IN(depth, VIEW).detections == ()
    (found,) = DETECT(depth, VIEW).detections
    assert found.x_m == pytest.approx(0.0, abs=0.1)
    assert found.z_m == pytest.approx((away_m - 0.3) / math.cos(math.radians(deg)) - 0.15, abs=0.1)
    assert found.height_m == pytest.approx(1.7, abs=0.15)


@settings(max_examples=20, deadline=None)
@given(deg=st.floats(-55.0, 55.0), away_m=st.floats(4.5, 7.0))
def test_a_wall_is_the_plane_that_it_is(deg: float, away_m: float) -> None:
    surface = oblique_wall(deg, away_m)
    (wall,) = DETECT(room_with(surface), VIEW).walls
    columns = np.arange(wall.left, wall.right + 1)
    np.testing.assert_allclose(wall.depth_m(columns, VIEW), surface[0, columns], rtol=0.01)


def test_a_corner_is_two_walls() -> None:
    walls = DETECT(room_with(oblique_wall(45.0, 4.5), oblique_wall(-45.0, 4.5)), VIEW).walls
    assert sorted(wall.slope for wall in walls) == pytest.approx([-0.0118, 0.0118], abs=0.001)


def test_nothing_is_left_of_a_wall() -> None:
    assert not DETECT(room_with(oblique_wall(30.0, 5.0)), VIEW).counts.any()


def test_whom_no_wall_is_behind_is_seen_as_before() -> None:
    depth = room_with(box_before_wall(20.0, 5.0, 0.0))
    assert DETECT(depth, VIEW).walls == ()
    assert DETECT(depth, VIEW).detections == LEFT_IN(depth, VIEW).detections


def test_what_is_narrow_and_tall_is_no_wall() -> None:
    tall = np.full((WIDTH, 2), np.nan)
    tall[100:140:4] = VIEW.disparity_px_m / 5.0, 0.0  # 0.6 m
    assert find_walls(tall, VIEW) == ()


def test_where_readings_scatter_too_much_walls_are_left_in() -> None:
    tall = np.full((WIDTH, 2), np.nan)
    tall[::4] = VIEW.disparity_px_m / 5.0, 0.2
    assert find_walls(tall, VIEW) == ()


def test_readings_off_the_wall_stay() -> None:
    tall = np.full((WIDTH, 2), np.nan)
    tall[::4] = VIEW.disparity_px_m / 5.0, 0.0
    (wall,) = find_walls(tall, VIEW)
    near, far = bands_mm((wall,), tall, 0.1, VIEW)
    depth = np.tile(np.array([[4700], [4950], [5050], [5300]], np.uint16), WIDTH)
    assert without(as_taken(depth), near, far)[:, 50].tolist() == [4700, 0, 0, 5300]
