"""People as upright bodies before cameras, against the same in whole arrays."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.truth.scenes import free_ray_shares, stand_before

SHARES = np.array([0.1, 0.3, 0.5, 0.7, 0.9])


def draw(
    rng: np.random.Generator, count: int
) -> tuple[Pinhole, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A camera, its poses on robots, and people: places, heights and radii."""
    camera = Pinhole(width=160, height=120, pitch_rad=rng.normal(0.0, 0.1), yaw_rad=rng.normal(0.0, 0.3))
    half = rng.uniform(-1.6, 1.6, count)
    turns = np.column_stack([np.zeros((count, 2)), np.sin(half), np.cos(half)])
    robots = pose_matrices(np.column_stack([rng.normal(0.0, 3.0, (count, 2)), np.zeros(count)]), turns)
    places = rng.normal(0.0, 4.0, (count, 2))
    return (
        camera, robots @ camera.robot_from_camera, places, rng.uniform(1.4, 2.0, count),
        rng.uniform(0.2, 0.3, count),
    )  # fmt: skip


def test_boxes_and_points_are_projections_of_head_feet_and_middle() -> None:
    camera, poses, places, heights, radii = draw(np.random.default_rng(0), 300)
    found = stand_before(places, heights, radii, camera, poses)
    before = 0
    for q in range(len(places)):
        up = np.array([[*places[q], z] for z in (heights[q], 0.0, heights[q] / 2.0)])
        seen = transform(invert_pose(poses[q]), up)
        points = np.array([[*places[q], share * heights[q]] for share in SHARES])
        (head, foot, middle), shown = (
            camera.project(seen),
            camera.project(transform(invert_pose(poses[q]), points)),
        )
        assert found.points[q] == pytest.approx(points)
        assert found.eyes[q] == pytest.approx(poses[q, :3, 3])
        inside = (np.abs(shown[:, 0] - 79.5) < 80.0) & (np.abs(shown[:, 1] - 59.5) < 60.0)
        assert np.array_equal(found.is_inside[q], inside)
        if seen[:, 2].min() < 0.05:
            assert np.isnan(found.boxes[q]).all()
            assert not found.reaches_in[q]
            continue
        before += 1
        half = camera.focal_px * radii[q] / seen[2, 2]
        box = [middle[0] - half, head[1], 2.0 * half, foot[1] - head[1]]
        assert found.boxes[q] == pytest.approx(box)
        left, top, width, height = box
        is_in = left < 160 and left + width > -0.5 and top < 120 and top + height > -0.5
        assert found.reaches_in[q] == is_in
    assert 50 < before < 250


def test_a_point_is_free_if_its_ray_ends_within_the_person() -> None:
    rng = np.random.default_rng(1)
    camera, poses, places, heights, radii = draw(rng, 300)
    uprights = stand_before(places, heights, radii, camera, poses)
    fraction = rng.choice([1.0, 0.97, 0.9, 0.5], (300, 5))
    short = np.linalg.norm(uprights.points - uprights.eyes[:, None], axis=2) * (1.0 - fraction)
    expected = (uprights.is_inside & (short <= 1.5 * radii[:, None])).mean(axis=1)
    found = free_ray_shares(uprights, fraction, radii)
    assert found == pytest.approx(np.where(uprights.reaches_in, expected, 0.0))
    assert 0.0 in found
    assert 1.0 in found
