"""Single rays against the ray caster, which draws shapes row by row from other formulas."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.rendering.renderer import cast
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.rays import hit_shape
from peopleboy.sim.shapes.shape_table import VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import ShapeKind

CAMERA = Pinhole(width=40, height=30, vertical_fov_rad=1.2, position_m=(0.0, 0.0, 0.0))
AHEAD = CAMERA.robot_from_camera


def cast_rays(kind: ShapeKind, size: tuple[float, float, float], pose: np.ndarray) -> tuple[View, np.ndarray]:
    """What the ray caster draws of a shape, and (H, W, 2) depth and surface by one ray after another."""
    table = make_shape_table([VisualShape(0, kind, size, pose, None)])
    view = cast(table, CAMERA, AHEAD, np.eye(4)[None], np.zeros(1, np.int64), np.zeros(1, np.bool_))
    shape_from_camera = invert_pose(pose) @ AHEAD
    rays = np.linalg.inv(CAMERA.intrinsics)
    hits = np.empty((CAMERA.height, CAMERA.width, 2))
    for v in range(CAMERA.height):
        for u in range(CAMERA.width):
            direction = shape_from_camera[:3, :3] @ rays @ (u, v, 1.0)
            hits[v, u] = hit_shape(int(kind), size, tuple(shape_from_camera[:3, 3]), tuple(direction))
    return view, hits


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from([kind for kind in ShapeKind if kind != ShapeKind.MESH]),
)
def test_a_ray_meets_what_the_ray_caster_draws_at_its_pixel(seed: int, kind: ShapeKind) -> None:
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=4)
    pose = pose_matrices(rng.normal(size=3) * 0.8 + (2.5, 0, 0), turn / np.linalg.norm(turn))
    view, hits = cast_rays(kind, tuple(rng.uniform(0.05, 1.5, 3)), pose)
    is_hit = np.isfinite(hits[..., 0]) & (hits[..., 0] < 99.0) & (hits[..., 0] > 0.06)
    # A ray that grazes an outline may fall to either side.
    assert np.count_nonzero(is_hit != (view.part == 0)) <= 2
    both = is_hit & (view.part == 0)
    np.testing.assert_allclose(hits[both, 0], view.depth[both], rtol=2e-4)
    assert view.surface is not None
    assert np.count_nonzero(hits[both, 1] != view.surface[both]) <= 2


def test_a_capsule_is_met_along_its_own_axis_at_its_end() -> None:
    assert hit_shape(int(ShapeKind.CAPSULE), (2.0, 0.5, 0.0), (0.0, 0.0, -5.0), (0.0, 0.0, 1.0)) == (3.5, 1)
    assert hit_shape(int(ShapeKind.CAPSULE), (2.0, 0.5, 0.0), (0.2, 0.0, 5.0), (0.0, 0.0, -2.0))[1] == 2


@pytest.mark.parametrize("kind", [ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX])
def test_a_shape_is_not_met_from_within_nor_behind(kind: ShapeKind) -> None:
    size = (1.0, 1.0, 1.0)
    assert hit_shape(int(kind), size, (0.1, 0.1, 0.1), (1.0, 0.2, 0.3))[0] == math.inf
    assert hit_shape(int(kind), size, (4.0, 0.1, 0.1), (1.0, 0.0, 0.0))[0] == math.inf
