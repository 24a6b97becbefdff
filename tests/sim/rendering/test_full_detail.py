"""Edges, mirrors and contact shadows against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.sim.cameras.imaging.lighting import (
    add_contact_shadows,
    light_on_floor,
    lost_light,
    mirrored_share,
)
from peopleboy.sim.geometry.pinhole import Pinhole, transform
from peopleboy.sim.rendering.edges import smooth
from peopleboy.sim.rendering.full_detail import REACH_M, find_contacts, gap
from peopleboy.sim.rendering.reflections import EVERY, Reflection, find_reflections
from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.rendering.renderer import PINHOLE_RENDERER, RenderPass, Scene, cast
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.shape_table import ShapeTable, VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import ShapeKind

CAMERA = Pinhole(width=80, height=60)
POSE = CAMERA.robot_from_camera.copy()  # which may be written to, as that of a world


def at(x: float, y: float, z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def draw(*shapes: tuple[ShapeKind, tuple[float, float, float], np.ndarray]) -> tuple[RenderPass, ShapeTable]:
    """What the camera sees of shapes, each a part of its own that is placed by its part's pose."""
    table = make_shape_table([VisualShape(i, s[0], s[1], np.eye(4), None) for i, s in enumerate(shapes)])
    poses = np.stack([s[2] for s in shapes])
    nobody, hidden = np.full(len(shapes), -1), np.zeros(len(shapes), np.bool_)
    view = cast(table, CAMERA, POSE, poses, nobody, hidden)
    scene = Scene(
        renderer="raycast", physics=None, table=table, world_from_part=poses, person_of_part=nobody,
        hidden=hidden,
    )  # type: ignore[arg-type] # fmt: skip
    return RenderPass(
        renderer=PINHOLE_RENDERER, scene=scene, camera=CAMERA, world_from_camera=POSE, view=view
    ), table


def smoothed(seen: RenderPass, values: tuple[float, ...]) -> np.ndarray:
    """The smoothed image of parts of these values, 0 where nothing is."""
    image = np.array([*values, 0.0], np.float32)[seen.view.part][..., None]
    smooth(image, 1e-3, seen, CAMERA)
    return image[..., 0]


FLOOR = (ShapeKind.PLANE, (0.0, 0.0, 0.0), np.eye(4))


@settings(max_examples=25, deadline=None)
@given(x=st.floats(2.0, 6.0), y=st.floats(-0.5, 0.5), radius=st.floats(0.2, 0.6))
def test_a_ball_fills_its_edge_pixels_by_the_share_of_their_area(x: float, y: float, radius: float) -> None:
    seen, table = draw((ShapeKind.SPHERE, (radius, 0.0, 0.0), at(x, y, 1.2)))
    found = smoothed(seen, (1.0,))
    fine = Pinhole(width=16 * CAMERA.width, height=16 * CAMERA.height)
    parts = cast(
        table, fine, POSE, seen.scene.world_from_part, np.zeros(1, np.int64), np.zeros(1, np.bool_)
    ).part
    share = (parts == 0).reshape(CAMERA.height, 16, CAMERA.width, 16).mean(axis=(1, 3))
    # A pixel at the border has too few neighbours.
    share, found = share[1:-1, 1:-1], found[1:-1, 1:-1]
    error = np.abs(found - share)
    is_edge = (share > 0.0) & (share < 1.0)
    # Of bent or slanted outlines four rays may know a little less than of others.
    assert error.max() <= 0.35
    assert np.quantile(error[is_edge], 0.9) <= 0.25
    assert error[is_edge].mean() < 0.12
    stairs = np.abs((seen.view.part == 0)[1:-1, 1:-1] - share)
    assert (error**2).sum() < 0.5 * (stairs**2).sum()


def test_where_box_and_floor_meet_both_have_their_share_and_all_else_keeps_its_value() -> None:
    seen, _ = draw(FLOOR, (ShapeKind.BOX, (1.0, 1.0, 1.0), at(3.0, 0.2, 0.5)))
    found, part = smoothed(seen, (1.0, 3.0)), seen.view.part
    same = np.ones(part.shape, np.bool_)
    for axis in (0, 1):
        for shift in (-1, 1):
            same &= np.roll(part, shift, axis) == part
    assert set(found[same].tolist()) <= {0.0, 1.0, 3.0}
    mixed = found[(found != 1.0) & (found != 3.0) & (found != 0.0)]
    assert len(mixed) > 10
    assert np.allclose(4.0 * mixed, np.rint(4.0 * mixed))


def test_faint_edges_are_left_as_they_are() -> None:
    seen, _ = draw(FLOOR, (ShapeKind.BOX, (1.0, 1.0, 1.0), at(3.0, 0.2, 0.5)))
    image = np.array([1.0, 1.0005, 1.0], np.float32)[seen.view.part][..., None]
    before = image.copy()
    smooth(image, 1e-3, seen, CAMERA)
    assert np.array_equal(image, before)


def mirrored(seen: RenderPass) -> list[tuple[Reflection, View]]:
    parts = np.arange(len(seen.scene.hidden))
    found = find_reflections(seen, CAMERA, parts == 0, parts == 1)
    return [(one, one.view) for one in found]


@settings(max_examples=25, deadline=None)
@given(x=st.floats(3.0, 6.0), y=st.floats(-1.0, 1.0), z=st.floats(0.5, 1.5))
def test_a_ball_is_mirrored_in_the_floor_as_a_ball_below_it(x: float, y: float, z: float) -> None:
    ball = (ShapeKind.SPHERE, (0.3, 0.0, 0.0))
    seen, _ = draw(FLOOR, (*ball, at(x, y, z)))
    below, _ = draw((*ball, at(x, y, -z)))
    is_there = np.zeros((CAMERA.height + 2, CAMERA.width + 2), np.bool_)
    for one, view in mirrored(seen):
        rows, columns = np.nonzero(view.part == 1)
        v, u = EVERY * rows + one.top, EVERY * columns + one.left
        is_inside = (v < CAMERA.height) & (u < CAMERA.width)
        is_there[v[is_inside], u[is_inside]] = True
        expected = below.view.depth[v[is_inside], u[is_inside]]
        np.testing.assert_allclose(view.depth[rows, columns][is_inside], expected, rtol=1e-4)
    expected = below.view.part == 0
    seen_floor = np.isfinite(seen.view.depth)
    for_floor = expected & seen_floor & (seen.view.part == 0)
    every_other = np.count_nonzero(for_floor) / EVERY**2
    found = np.count_nonzero(is_there[: CAMERA.height, : CAMERA.width] & for_floor)
    assert found == pytest.approx(every_other, abs=4 + 0.1 * every_other)


def test_what_stands_behind_a_mirror_or_behind_a_wall_is_not_mirrored() -> None:
    ball = (ShapeKind.SPHERE, (0.3, 0.0, 0.0), at(4.5, 0.0, 1.2))
    pane = (ShapeKind.BOX, (0.05, 3.0, 3.0), at(3.0, 0.0, 1.0))
    seen, _ = draw(pane, ball)
    assert mirrored(seen) == []
    above = (ShapeKind.SPHERE, (0.3, 0.0, 0.0), at(4.5, 0.0, 1.2))
    ceiling = (ShapeKind.BOX, (20.0, 20.0, 0.02), at(4.5, 0.0, 0.6))
    seen, _ = draw(FLOOR, above, ceiling)
    assert mirrored(seen) == []


def test_a_thing_is_mirrored_whose_frame_lies_in_the_mirror() -> None:
    lifted = np.eye(4)
    lifted[2, 3] = 0.8
    shapes = [
        VisualShape(0, ShapeKind.PLANE, (0.0, 0.0, 0.0), np.eye(4), None),
        VisualShape(1, ShapeKind.BOX, (0.4, 0.4, 1.6), lifted, None),
    ]
    seen, _ = draw(FLOOR, (ShapeKind.BOX, (0.4, 0.4, 1.6), at(4.5, 0.0, 0.0)))
    table = make_shape_table(shapes)
    view = cast(table, CAMERA, POSE, seen.scene.world_from_part, np.full(2, -1), np.zeros(2, np.bool_))
    seen = replace(seen, view=view, scene=replace(seen.scene, table=table))
    [(_, reflection)] = mirrored(seen)
    assert np.count_nonzero(reflection.part == 1) > 10


def test_a_mirror_ahead_shows_who_is_behind_the_camera() -> None:
    pane = (ShapeKind.BOX, (0.05, 3.0, 3.0), at(3.0, 0.0, 1.2))
    seen, _ = draw(pane, (ShapeKind.SPHERE, (0.3, 0.0, 0.0), at(-2.0, 0.0, 1.2)))
    [(one, view)] = mirrored(seen)
    rows, columns = np.nonzero(view.part == 1)
    # The front of the pane is at 2.975 m: the ball seems to be at 7.95 m, and 0.3 m nearer in its middle.
    assert view.depth[rows, columns].min() == pytest.approx(7.95 - 0.3 - CAMERA.position_m[0], abs=0.01)
    assert EVERY * columns.mean() + one.left == pytest.approx(CAMERA.centre_px[0], abs=0.6)
    assert one.cosine[rows, columns].min() > 0.99


def test_glass_mirrors_a_twenty_fifth_straight_on_and_all_at_grazing() -> None:
    assert mirrored_share(0.04, 1.0) == pytest.approx(0.04)
    assert mirrored_share(0.04, 0.0) == pytest.approx(1.0)
    shares = [mirrored_share(0.04, cosine) for cosine in np.linspace(0.0, 1.0, 20)]
    assert shares == sorted(shares, reverse=True)


def test_a_wall_takes_half_of_the_light_at_its_foot_and_none_out_of_reach() -> None:
    table = make_shape_table([VisualShape(0, ShapeKind.BOX, (0.2, 8.0, 2.0), at(0.0, 0.0, 1.0), None)])
    contacts = find_contacts(table, np.eye(4)[None], np.zeros(1, np.bool_))
    [wall] = contacts.prints
    assert gap(wall, 0.4, 1.0) == pytest.approx(0.3)
    assert gap(wall, 0.0, 4.3) == pytest.approx(0.3)
    assert gap(wall, 0.05, 0.0) == 0.0
    assert lost_light(wall, 0.0) == pytest.approx(0.5)
    assert lost_light(wall, REACH_M) == 0.0
    losses = [lost_light(wall, away) for away in np.linspace(0.0, REACH_M, 30)]
    assert losses == sorted(losses, reverse=True)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 9999), turn=st.floats(-3.0, 3.0))
def test_light_on_the_floor_is_what_all_footprints_leave_of_it(seed: int, turn: float) -> None:
    rng, count = np.random.default_rng(seed), 12
    kinds = rng.choice([ShapeKind.BOX, ShapeKind.CAPSULE], count)
    sizes = [tuple(rng.uniform(0.05, 0.6, 3)) for _ in range(count)]
    poses = np.stack([at(*rng.uniform((-3.0, -3.0, 0.0), (6.0, 3.0, 0.5))) for _ in range(count)])
    for pose, about in zip(poses, rng.uniform(0.0, 6.0, count), strict=True):
        pose[:2, :2] = [[np.cos(about), -np.sin(about)], [np.sin(about), np.cos(about)]]
    table = make_shape_table(
        [VisualShape(i, *one, np.eye(4), None) for i, one in enumerate(zip(kinds, sizes, strict=True))]
    )
    prints = find_contacts(table, poses, np.zeros(count, np.bool_)).prints
    turned = np.eye(4)
    turned[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    eye = turned @ POSE
    found = light_on_floor(Lens(CAMERA.focal_px, *CAMERA.centre_px, CAMERA.width, CAMERA.height), eye, prints)
    for j, i in np.ndindex(found.shape):
        ray = eye[:3, :3] @ np.linalg.inv(CAMERA.intrinsics) @ (4.0 * i, 4.0 * j, 1.0)
        left = 1.0
        if ray[2] < 0.0:
            x, y = (eye[:3, 3] - ray * eye[2, 3] / ray[2])[:2]
            left = np.prod([1.0 - lost_light(row, gap(row, x, y)) for row in prints])
        assert found[j, i] == pytest.approx(1.0 - 0.6 * min(1.0 - left, 0.85), abs=1e-5)


def test_what_hangs_high_takes_less_light_than_what_stands() -> None:
    row = np.array([0.0, 0.0, 1.0, 0.0, 0.1, 0.05, 0.02, 0.0, 0.3])
    high = row + np.array([0, 0, 0, 0, 0, 0, 0, 0.2, 0.2])
    assert lost_light(high, 0.05) < 0.4 * lost_light(row, 0.05)


def test_the_floor_is_darker_only_near_a_leg_and_nothing_else_is() -> None:
    leg = (ShapeKind.CAPSULE, (0.4, 0.06, 0.0), at(3.0, 0.3, 0.26))
    seen, table = draw(FLOOR, leg)
    image = np.ones((*seen.view.part.shape, 3), np.float32)
    contacts = find_contacts(table, seen.scene.world_from_part, seen.scene.hidden)
    add_contact_shadows(image, seen.view, CAMERA, POSE, contacts)
    v, u = np.indices(seen.view.part.shape)
    rays = np.stack([u, v, np.ones(u.shape)], -1) @ np.linalg.inv(CAMERA.intrinsics).T
    is_floor = seen.view.part == 0
    points = transform(POSE, rays[is_floor] * seen.view.depth[is_floor, None])
    away = np.hypot(points[:, 0] - 3.0, points[:, 1] - 0.3)
    light = image[is_floor][:, 0]
    assert np.all(image[~is_floor] == 1.0)
    assert light[away < 0.2].min() < 0.95
    # Light is linear between the pixels that are reckoned, which lie far apart in so small an image.
    assert light[away > REACH_M + 1.5].min() == 1.0
