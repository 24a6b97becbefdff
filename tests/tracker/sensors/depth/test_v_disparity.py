"""Floor and ceiling in the v-disparity image."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.depth.v_disparity import (
    BIN_PX,
    estimate_camera_pose,
    find_ceiling,
    find_floor,
    v_disparity,
)
from tests.helpers.depth_scene import HEIGHT, WIDTH, Block, depth_of, make_view


@settings(max_examples=15, deadline=None)
@given(height_m=st.floats(0.7, 1.7), horizon_px=st.floats(-8.0, 8.0))
def test_floor_is_found_at_the_height_and_slope_of_the_camera(height_m: float, horizon_px: float) -> None:
    view = make_view()
    counts = v_disparity(depth_of(height_m=height_m, ceiling_m=3.0, horizon_px=horizon_px), view)
    floor = find_floor(counts, view)
    assert floor is not None
    at = np.array([2.0, 4.0, 6.0])
    expected = view.centre_v + horizon_px + view.focal_px * height_m / at
    assert floor.rows(at, view) == pytest.approx(expected, abs=3.0)


def test_a_floor_that_is_only_seen_from_afar_is_not_searched_for() -> None:
    depth = depth_of([Block(0.0, 3.0)], height_m=1.5)[:140]
    view = make_view(1.5)
    assert find_floor(v_disparity(depth, view), view) is None


@pytest.mark.parametrize(("height_m", "pitch_deg"), [(1.2, 0.0), (0.6, -6.0), (1.55, 16.0), (2.2, 40.0)])
def test_pose_is_that_of_the_plane_below_the_camera(height_m: float, pitch_deg: float) -> None:
    view, pitch_rad = make_view(), np.radians(pitch_deg)
    down = np.cos(pitch_rad) * (np.arange(HEIGHT) - view.centre_v) / view.focal_px + np.sin(pitch_rad)
    z_m = np.where(down > height_m / 8.0, height_m / np.maximum(down, 1e-3), 8.0)
    noise_m = np.random.default_rng(1).normal(0.0, 0.003, (3, HEIGHT, WIDTH)) * z_m[:, None] ** 2
    depths = np.rint(1000.0 * (z_m[:, None] + noise_m)).astype(np.uint16)
    assert estimate_camera_pose(depths, view) == pytest.approx((height_m, pitch_rad), abs=0.03)


def test_without_a_floor_in_half_of_the_images_there_is_no_pose() -> None:
    view, wall = make_view(), np.full((HEIGHT, WIDTH), 2500, np.uint16)
    assert estimate_camera_pose([], view) is None
    assert estimate_camera_pose([wall, wall, depth_of()], view) is None
    assert estimate_camera_pose([wall, depth_of()], view) == pytest.approx((1.2, 0.0), abs=0.02)


def test_ceiling_is_found_above_the_camera() -> None:
    view = make_view()
    ceiling = find_ceiling(v_disparity(depth_of(ceiling_m=2.6), view), view)
    assert ceiling is not None
    assert ceiling.offset_m == pytest.approx(1.2 - 2.6, abs=0.05)


def test_a_wall_alone_has_no_floor() -> None:
    view = make_view()
    wall = np.full((HEIGHT, WIDTH), 2500, np.uint16)
    assert find_floor(v_disparity(wall, view), view) is None


def test_people_before_the_floor_do_not_move_it() -> None:
    view = make_view()
    crowd = [Block(x, z) for x, z in ((-1.0, 3.0), (0.0, 3.5), (0.9, 4.0), (1.5, 5.0))]
    empty, full = (find_floor(v_disparity(depth_of(who), view), view) for who in ((), crowd))
    assert empty is not None
    assert full is not None
    assert full.offset_m == pytest.approx(empty.offset_m, abs=0.02)


def test_every_reading_is_counted_once_in_the_row_and_bin_of_its_disparity() -> None:
    view, depth = make_view(), depth_of([Block(0.2, 3.0)])
    counts = v_disparity(depth, view)
    assert counts.sum(axis=1).tolist() == [WIDTH] * HEIGHT
    v, u = 100, 170
    assert counts[v, round(view.disparity_px_m / (depth[v, u] / 1000.0) / BIN_PX)] > 0


def test_holes_are_not_counted() -> None:
    assert v_disparity(np.zeros((HEIGHT, WIDTH), np.uint16), make_view()).sum() == 0
