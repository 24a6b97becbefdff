import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.rendering.render import cast
from peopleboy.sim.rendering.sight import silhouette_area, silhouette_bounds
from peopleboy.sim.shapes.shape_table import ShapeTable, VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import ShapeKind

KINDS = [ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX]
EVERYTHING = np.ones(1, np.bool_)
HERE = np.eye(4)[None]


def bounds_of(table: ShapeTable, camera: Pinhole, pose: np.ndarray) -> np.ndarray:
    return silhouette_bounds(camera, table, invert_pose(pose) @ HERE, EVERYTHING[None])[0]


def area_of(table: ShapeTable, camera: Pinhole, pose: np.ndarray) -> int:
    bounds = bounds_of(table, camera, pose).tolist()
    return silhouette_area(camera, table, invert_pose(pose) @ HERE, EVERYTHING, bounds)


def random_table(rng: np.random.Generator, spread_m: float, distance_m: float) -> ShapeTable:
    shapes = []
    for kind in KINDS:
        orientation = rng.normal(size=4)
        pose = pose_matrices(
            rng.normal(size=3) * spread_m + (distance_m, 0, 0), orientation / np.linalg.norm(orientation)
        )
        shapes.append(VisualShape(0, kind, tuple(rng.uniform(0.1, 0.4, 3)), pose, None))
    return make_shape_table(shapes)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_bounds_lie_around_the_drawn_silhouette_by_less_than_a_pixel(seed: int) -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    table = random_table(np.random.default_rng(seed), 0.4, 4.0)
    view = cast(table, camera, camera.robot_from_camera, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    bounds = bounds_of(table, camera, camera.robot_from_camera)
    assume(bounds[0] > 0 and bounds[1] > 0 and bounds[2] < 319 and bounds[3] < 239)
    v, u = np.nonzero(view.cover)
    drawn = (u.min(), v.min(), u.max(), v.max())
    gaps = np.array(drawn) - bounds
    assert np.all(gaps[:2] > -1e-6)
    assert np.all(gaps[2:] < 1e-6)
    # A box may end in a corner that no pixel's centre falls on.
    assert np.all(np.abs(gaps) < 2.5)
    assert np.median(np.abs(gaps)) < 1.0
    area = area_of(table, camera, camera.robot_from_camera)
    assert area == np.count_nonzero(view.cover)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_bounds_of_large_shapes_are_met_within_a_pixel(kind: ShapeKind) -> None:
    rng = np.random.default_rng(kind)
    camera = Pinhole(position_m=(0.0, 0.0, 0.0), width=1600, height=1200)
    for _ in range(10):
        orientation = rng.normal(size=4)
        pose = pose_matrices((4, 0.2, 0.1), orientation / np.linalg.norm(orientation))
        table = make_shape_table([VisualShape(0, kind, (0.9, 0.6, 0.7), pose, None)])
        view = cast(table, camera, camera.robot_from_camera, HERE, np.zeros(1, np.int64), ~EVERYTHING)
        bounds = bounds_of(table, camera, camera.robot_from_camera)
        v, u = np.nonzero(view.cover)
        sharp = 3.0 if kind == ShapeKind.BOX else 1.0
        np.testing.assert_allclose(bounds, (u.min(), v.min(), u.max(), v.max()), atol=sharp)


def test_bounds_and_area_do_not_change_when_a_camera_turns_the_shape_out_of_its_image() -> None:
    table = random_table(np.random.default_rng(1), 0.1, 4.0)
    wide = Pinhole(position_m=(0.0, 0.0, 0.0), width=960, height=720, vertical_fov_rad=2 * math.atan(0.9))
    narrow = Pinhole(position_m=(0.0, 0.0, 0.0), width=320, height=240, vertical_fov_rad=2 * math.atan(0.3))
    assert wide.focal_px == pytest.approx(narrow.focal_px)
    turned = Pinhole(yaw_rad=0.4, pitch_rad=0.3, position_m=(0.0, 0.0, 0.0)).robot_from_camera
    view = cast(table, wide, turned, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    seen = cast(table, narrow, turned, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    assert 0 < np.count_nonzero(seen.cover) < np.count_nonzero(view.cover)
    bounds = bounds_of(table, narrow, turned)
    expected = bounds_of(table, wide, turned)
    np.testing.assert_allclose(np.add(bounds, (320, 240, 320, 240)), expected)
    assert area_of(table, narrow, turned) == np.count_nonzero(view.cover)


def test_bounds_of_what_reaches_behind_the_camera_stop_at_the_near_plane() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    beam = VisualShape(0, ShapeKind.BOX, (10.0, 0.2, 0.2), pose_matrices((0, 1, 0), (0, 0, 0, 1)), None)
    bounds = bounds_of(make_shape_table([beam]), camera, camera.robot_from_camera)
    u, focal = camera.centre_px[0], camera.focal_px
    assert bounds[0] == pytest.approx(u - focal * 1.1 / 0.05)
    assert bounds[2] == pytest.approx(u - focal * 0.9 / 5.0)
    rod = VisualShape(
        0, ShapeKind.CAPSULE, (9.8, 0.1, 0.0), pose_matrices((0, 1, 0), (0, 0.5**0.5, 0, 0.5**0.5)), None
    )
    same = bounds_of(make_shape_table([rod]), camera, camera.robot_from_camera)
    np.testing.assert_allclose(same[0], bounds[0], rtol=0.02)


def test_nothing_in_front_of_the_camera_has_no_bounds_and_no_area() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    for kind in KINDS:
        table = make_shape_table(
            [VisualShape(0, kind, (1, 1, 1), pose_matrices((-3, 0, 0), (0, 0, 0, 1)), None)]
        )
        assert np.all(np.isnan(bounds_of(table, camera, camera.robot_from_camera)))
        assert area_of(table, camera, camera.robot_from_camera) == 0
