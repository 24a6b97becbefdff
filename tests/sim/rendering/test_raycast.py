"""The ray caster against closed forms and against marching along rays by distance functions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.rendering.renderer import cast
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.shape_table import VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

Array = NDArray[np.float64]

AHEAD = Pinhole(position_m=(0.0, 0.0, 0.0)).robot_from_camera


def draw(*shapes: VisualShape, camera: Pinhole, pose: Array = AHEAD) -> View:
    parts = 1 + max(shape.part for shape in shapes)
    table = make_shape_table(shapes)
    here = np.tile(np.eye(4), (parts, 1, 1))
    return cast(table, camera, pose, here, np.arange(parts), np.zeros(parts, np.bool_))


def one(kind: ShapeKind, size: tuple[float, float, float], pose: Array, part: int = 0) -> VisualShape:
    return VisualShape(part, kind, size, pose, None)


def distance(kind: ShapeKind, size: tuple[float, float, float], p: Array) -> Array:
    """Signed distance of points (..., 3) to a shape in its own frame."""
    if kind == ShapeKind.SPHERE:
        return np.linalg.norm(p, axis=-1) - size[0]
    if kind == ShapeKind.CAPSULE:
        axis = np.zeros(p.shape)
        axis[..., 2] = np.clip(p[..., 2], -size[0] / 2, size[0] / 2)
        return np.linalg.norm(p - axis, axis=-1) - size[1]
    if kind == ShapeKind.CYLINDER:
        beyond = np.stack([np.hypot(p[..., 0], p[..., 1]) - size[1], np.abs(p[..., 2]) - size[0] / 2], -1)
    else:
        beyond = np.abs(p) - np.array(size) / 2
    return np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)


def march(
    kind: ShapeKind, size: tuple[float, float, float], rays: Array, origin: Array
) -> tuple[Array, Array]:
    """Way along unit rays to the shape (inf where they miss it), and which rays do more than graze it."""
    way, nearest = np.zeros(rays.shape[:-1]), np.full(rays.shape[:-1], np.inf)
    for _ in range(400):
        gap = distance(kind, size, origin + way[..., None] * rays)
        nearest = np.minimum(nearest, gap)
        way += gap
    hit, missed = gap < 1e-7, way > 30.0
    return np.where(hit, way, np.inf), (hit & (gap < 1e-9)) | (missed & (nearest > 1e-3))


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from([ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX]),
)
def test_depth_and_normal_are_those_found_by_marching_along_the_rays(seed: int, kind: ShapeKind) -> None:
    rng = np.random.default_rng(seed)
    size = tuple(rng.uniform(0.05, 2.0, 3))
    orientation = rng.normal(size=4)
    pose = pose_matrices(
        rng.normal(size=3) * (1, 1, 1) + (2, 0, 0), orientation / np.linalg.norm(orientation)
    )
    camera = Pinhole(width=40, height=30, vertical_fov_rad=1.2)
    shape_from_world = invert_pose(pose)
    if distance(kind, size, transform(shape_from_world, np.zeros(3))) < 0.1:
        return
    view = draw(one(kind, size, pose), camera=camera)
    v, u = np.indices((30, 40))
    optical = np.stack([u, v, np.ones(u.shape)], -1) @ np.linalg.inv(camera.intrinsics).T
    length = np.linalg.norm(optical, axis=-1)
    rays = optical / length[..., None] @ AHEAD[:3, :3].T
    way, clear = march(
        kind, size, rays @ shape_from_world[:3, :3].T, transform(shape_from_world, np.zeros(3))
    )
    depth = way / length
    hit = np.isfinite(depth) & clear
    assert np.mean(clear) > 0.95
    assert np.array_equal(view.part[clear] == 0, hit[clear])
    np.testing.assert_allclose(view.depth[hit], depth[hit], rtol=2e-4)
    points = transform(shape_from_world, view.depth[hit, None] * optical[hit] @ AHEAD[:3, :3].T)
    steps = 1e-4 * np.eye(3)
    gradient = np.stack(
        [distance(kind, size, points + s) - distance(kind, size, points - s) for s in steps], -1
    )
    agree = np.sum(gradient / 2e-4 @ pose[:3, :3].T * view.normal[hit], axis=-1)
    # Across an edge the difference quotient mixes two faces.
    assert np.sum(agree <= 0.999) <= 4 + 0.1 * len(agree)


def test_a_sphere_straight_ahead_has_the_depth_and_size_of_the_textbook() -> None:
    camera = Pinhole(width=321, height=241, position_m=(0.0, 0.0, 0.0))
    view = draw(one(ShapeKind.SPHERE, (0.4, 0, 0), pose_matrices((3, 0, 0), (0, 0, 0, 1))), camera=camera)
    assert view.depth[120, 160] == pytest.approx(2.6)
    np.testing.assert_allclose(view.normal[120, 160], (-1, 0, 0), atol=1e-6)
    radius = camera.focal_px * math.tan(math.asin(0.4 / 3.0))
    v, u = np.nonzero(view.part == 0)
    assert u.max() == math.floor(160 + radius)
    assert u.min() == math.ceil(160 - radius)
    assert v.max() == math.floor(120 + radius)
    assert v.min() == math.ceil(120 - radius)
    assert np.all(np.isinf(view.depth[view.part < 0]))


def test_a_plane_is_seen_from_above_only_and_ends_at_the_horizon() -> None:
    level = Pinhole(position_m=(0.0, 0.0, 1.2))
    floor = one(ShapeKind.PLANE, (0, 0, 0), np.eye(4))
    view = draw(floor, camera=level, pose=level.robot_from_camera)
    v = np.arange(240)
    depth = 1.2 * level.focal_px / np.maximum(v - level.centre_px[1], 1e-9)
    below = depth < 100.0
    np.testing.assert_allclose(view.depth[below], np.repeat(depth[below, None], 320, 1), rtol=1e-6)
    assert np.all(view.part[~below] == -1)
    under = Pinhole(position_m=(0.0, 0.0, -1.2), pitch_rad=-0.5)
    assert np.all(draw(floor, camera=under, pose=under.robot_from_camera).part == -1)


def test_a_wall_that_runs_past_the_camera_fills_its_side_of_the_image() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    wall = one(ShapeKind.BOX, (50, 0.2, 50), pose_matrices((0, 1.1, 0), (0, 0, 0, 1)))
    view = draw(wall, camera=camera)
    u = np.arange(320)
    depth = camera.focal_px / np.maximum(camera.centre_px[0] - u, 1e-9)
    seen = depth < 25.0
    np.testing.assert_allclose(view.depth[120][seen], depth[seen], rtol=1e-6)
    assert np.all(view.part[:, ~seen] == -1)


def test_a_camera_inside_a_solid_does_not_see_it() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    for kind in (ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX):
        assert np.all(draw(one(kind, (2, 2, 2), np.eye(4)), camera=camera).part == -1)


def test_cover_shows_whole_silhouettes_behind_what_hides_them() -> None:
    rng = np.random.default_rng(3)
    camera = Pinhole()
    people = [
        one(ShapeKind.CAPSULE, (0.6, 0.2, 0), pose_matrices((x, rng.normal() * 0.3, 0), (0, 0, 0, 1)), part)
        for part, x in enumerate((3.0, 4.0, 5.0))
    ]
    wall = one(ShapeKind.BOX, (0.1, 9, 9), pose_matrices((2, 0, 0), (0, 0, 0, 1)), 3)
    together = draw(*people, wall, camera=camera)
    assert np.all(together.part == 3)
    for part, person in enumerate(people):
        alone = draw(person, camera=camera)
        bit = np.uint64(1) << np.uint64(part)
        assert np.array_equal((together.cover & bit) > 0, alone.part == part)


def test_pieces_of_one_shape_leave_no_crack_between_them() -> None:
    rng = np.random.default_rng(4)
    camera = Pinhole(width=160, height=120)
    for _ in range(50):
        orientation = rng.normal(size=4)
        pose = pose_matrices((3, 0, 0), orientation / np.linalg.norm(orientation))
        for kind in (ShapeKind.BOX, ShapeKind.CYLINDER, ShapeKind.CAPSULE):
            mask = draw(one(kind, (1, 0.5, 0.7), pose), camera=camera).part == 0
            # A convex outline meets each row and each column in one piece.
            for lines in (mask, mask.T):
                assert np.all(
                    np.abs(np.diff(np.pad(lines, ((0, 0), (1, 1))).astype(int), axis=1)).sum(1) <= 2
                )


def test_a_pose_that_is_not_a_number_draws_nothing() -> None:
    for kind in (ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX, ShapeKind.PLANE):
        broken = one(kind, (1, 1, 1), np.full((4, 4), np.nan))
        assert np.all(draw(broken, camera=Pinhole()).part == -1)


def test_the_arrays_of_a_table_cannot_be_written_to() -> None:
    with Bullet() as bullet:
        bullet.add_part("ball", [Shape(kind=ShapeKind.SPHERE, size=(1.0, 0.0, 0.0))])
        table = make_shape_table(bullet.visual_shapes())
    for array in table:
        assert not array.flags.writeable
