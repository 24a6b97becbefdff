import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.footprints import MOST_POINTS, footprint, overlap
from peopleboy.sim.shapes.shapes import ShapeKind

HALF = np.array([0.25, 0.19])


def outline_of(rng: np.random.Generator, corners: int) -> np.ndarray:
    points = rng.normal(size=(corners, 2)) * 0.3 + rng.uniform(-0.6, 0.6, 2)
    return points[ConvexHull(points).vertices] if corners > 2 else points


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.sampled_from([0.0, 0.1]))
def test_a_push_by_the_depth_along_the_normal_just_parts_them(seed: int, corners: int, radius: float) -> None:
    outline = outline_of(np.random.default_rng(seed), corners)
    depth, nx, ny, _ = overlap(HALF, outline, radius)
    if depth == -math.inf:
        return
    assert math.hypot(nx, ny) == pytest.approx(1.0)
    # The rectangle's frame moves with it, and so the outline the other way.
    after, *_ = overlap(HALF, outline - (depth - 1e-6) * np.array([nx, ny]), radius)
    assert after == pytest.approx(1e-6, abs=1e-7)
    further, *_ = overlap(HALF, outline - (depth + 0.01) * np.array([nx, ny]), radius)
    assert further < 0.0


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 5))
def test_apart_the_depth_is_the_distance(seed: int, corners: int) -> None:
    outline = outline_of(np.random.default_rng(seed), corners)
    depth, *_ = overlap(HALF, outline, 5.0)
    if depth > 5.0:
        return
    shares = np.linspace(0.0, 1.0, 2001)[:, None]
    border = np.concatenate(
        [a + shares * (b - a) for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True)]
    )
    away = np.linalg.norm(np.maximum(np.abs(border) - HALF, 0.0), axis=1).min()
    assert 5.0 - depth == pytest.approx(away, abs=2e-3)


def as_kept(size: tuple[float, float, float]) -> np.ndarray:
    """A size as tables of shapes keep it, which cannot be written to: kernels are compiled for that."""
    array = np.array(size)
    array.setflags(write=False)
    return array


@pytest.mark.parametrize(
    ("kind", "size", "area"),
    [
        (ShapeKind.BOX, (0.4, 0.6, 2.0), 0.24),
        (ShapeKind.CYLINDER, (2.0, 0.3, 0.0), None),
        (ShapeKind.BOX, (0.4, 0.6, 0.05), None),
    ],
)
def test_a_shape_upright_has_its_own_cross_section_where_it_reaches(
    kind: ShapeKind, size: tuple[float, float, float], area: float | None
) -> None:
    outline = np.empty((MOST_POINTS + 1, 2))
    pose = pose_matrices((1.0, 2.0, 0.0), (0.0, 0.0, math.sin(0.3), math.cos(0.3)))
    count, radius = footprint(int(kind), as_kept(size), pose, 0.1, 0.3, outline)
    if size[2] == 0.05:
        assert count == 0
    elif area is None:
        assert (count, radius) == (1, 0.3)
    else:
        assert (count, radius) == (4, 0.0)
        assert ConvexHull(outline[:4]).volume == pytest.approx(area)
        x, y = (np.roll(outline[:4], -1, axis=0) - outline[:4]).T
        assert np.all(x * np.roll(y, -1) - y * np.roll(x, -1) > 0.0)  # counter-clockwise


def test_a_leaning_box_has_what_lies_between_the_heights() -> None:
    """A square post of 45 degrees is cut as wide as its height shows, and lies where it leans to."""
    outline = np.empty((MOST_POINTS + 1, 2))
    half = math.radians(45.0) / 2.0
    pose = pose_matrices((0.0, 0.0, 0.0), (0.0, math.sin(half), 0.0, math.cos(half)))
    count, _ = footprint(int(ShapeKind.BOX), as_kept((0.2, 0.4, 4.0)), pose, 0.5, 0.7, outline)
    wide = 0.1 * math.sqrt(2.0)
    assert outline[:count, 0].min() == pytest.approx(0.5 - wide)
    assert outline[:count, 0].max() == pytest.approx(0.7 + wide)
    assert np.ptp(outline[:count, 1]) == pytest.approx(0.4)


def test_a_ball_is_as_wide_as_it_is_at_the_nearest_height() -> None:
    outline = np.empty((MOST_POINTS + 1, 2))
    pose = pose_matrices((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    count, radius = footprint(int(ShapeKind.SPHERE), as_kept((0.5, 0.0, 0.0)), pose, 0.3, 0.9, outline)
    assert (count, radius) == (1, pytest.approx(0.4))
