from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import ArrayLike

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.panorama import MIRRORS, Mirror, Panorama

BOTH = pytest.mark.parametrize("mirror", MIRRORS.values(), ids=MIRRORS)


def floor_distance(camera: Panorama, rows: ArrayLike) -> np.ndarray:
    """How far from the axis [m] the floor is that rows see, from the ring and by how far they look down."""
    return camera.mirror.ring_radius_m + camera.mirror.ring_height_m / np.tan(camera.depression(rows))


@BOTH
def test_rays_are_those_that_the_law_of_reflection_gives(mirror: Mirror) -> None:
    camera = Panorama(mirror=mirror)
    lens = np.array([0.0, mirror.apex_m - mirror.lens_m])
    side = np.array([math.sin(mirror.half_apex_rad), math.cos(mirror.half_apex_rad)])
    for row in range(0, camera.height, 7):
        off_axis = math.atan((camera.height - 0.5 - row) / camera.focal_px)
        ray = np.array([math.sin(off_axis), math.cos(off_axis)])
        far, _ = np.linalg.solve(np.stack([ray, -side], axis=1), np.array([0.0, mirror.apex_m]) - lens)
        hit = lens + far * ray
        out = 2.0 * (ray @ side) * side - ray
        floor = hit[0] - out[0] / out[1] * hit[1]
        assert camera.depression(row) == pytest.approx(math.atan2(-out[1], out[0]), abs=1e-12)
        assert floor_distance(camera, row) == pytest.approx(floor, rel=1e-9)


@BOTH
def test_points_on_the_floor_are_projected_to_the_row_that_sees_them(mirror: Mirror) -> None:
    camera = Panorama(mirror=mirror)
    rows, columns = np.arange(camera.height), np.arange(0, camera.width, 5)[:, None]
    distance, bearing = floor_distance(camera, rows), camera.bearing(columns)
    down = np.broadcast_to(mirror.ring_height_m, (len(columns), len(rows)))
    points = np.stack([-distance * np.sin(bearing), down, distance * np.cos(bearing)], axis=-1)
    expected = np.stack(np.broadcast_arrays(columns, rows), axis=-1)
    np.testing.assert_allclose(camera.project(points), expected, atol=1e-7)


def test_the_usual_mirror_shows_what_its_source_says() -> None:
    camera = Panorama()
    assert camera.focal_px == pytest.approx(111.9, abs=0.05)
    assert camera.mirror.ring_height_m == pytest.approx(1.713, abs=5e-4)
    assert camera.mirror.ring_radius_m == pytest.approx(-0.023, abs=5e-4)
    low, high = floor_distance(camera, np.array([119.5, -0.5]))
    assert (low, high) == pytest.approx((1.18, 12.2), abs=0.05)
    assert floor_distance(Panorama(mirror=MIRRORS["narrow"]), 119.5) == pytest.approx(2.36, abs=0.05)


def test_the_seam_is_behind_the_robot_and_its_left_is_left() -> None:
    camera = Panorama()
    assert camera.bearing([-0.5, 119.5, 239.5, 479.5]) == pytest.approx([math.pi, math.pi / 2, 0, -math.pi])
    left, ahead = camera.project(np.array([[-2.0, 1.0, 0.0], [0.0, 1.0, 2.0]]))
    assert (left[0], ahead[0]) == pytest.approx((119.5, 239.5))


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"half_apex_rad": math.radians(40.0)}, ("half_apex_deg", "40", "floor")),
        ({"half_apex_rad": math.nan}, ("half_apex_deg", "nan")),
        ({"lens_half_angle_rad": math.radians(80.0)}, ("lens_half_angle_deg", "80", "72.5")),
        ({"lens_m": 0.0}, ("lens_m", "0")),
        ({"apex_m": 0.02}, ("apex_m", "0.02")),
    ],
)
def test_a_mirror_that_cannot_be_used_is_refused(values: dict[str, float], named: tuple[str, ...]) -> None:
    with pytest.raises(BadInput) as refused:
        Mirror(**values)
    assert all(word in str(refused.value) for word in named)
