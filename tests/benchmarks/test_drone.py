from __future__ import annotations

import numpy as np
import pytest

from benchmarks.speed.drone import SIZE, DroneWorld, drone_mesh
from peopleboy.sim.physics.bullet_io import metric_depth


def test_the_drone_hovers_and_sees_itself_the_plane_and_a_block_a_metre_ahead() -> None:
    with DroneWorld() as world:
        for _ in range(20):
            world.step()
        colours, depth, parts = world.see()
    assert colours.shape == (*SIZE[::-1], 4)
    nothing, plane, block, drone = -1, 0, 1, 5
    assert (parts[0] == nothing).all()
    assert (parts == drone).any()
    assert (parts == plane).sum() > parts.size / 4
    ahead_m = metric_depth(depth, 0.0397, 1000.0)[parts == block]
    assert ahead_m == pytest.approx(np.full(ahead_m.shape, 0.95), abs=0.02)
    assert ahead_m.size


def test_its_mesh_is_closed_and_has_as_many_triangles_as_the_drone_of_the_other_world() -> None:
    corners, triangles = drone_mesh()
    assert len(triangles) == pytest.approx(9434, abs=10)
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    there, back = {tuple(edge) for edge in edges.tolist()}, {tuple(edge) for edge in edges[:, ::-1].tolist()}
    assert len(there) == len(edges)
    assert there == back
    first, second, third = np.moveaxis(corners[triangles], 1, 0)
    volume_m3 = (np.cross(first, second) * third).sum() / 6.0
    assert 0.0 < volume_m3 < 2.0 * 0.06 * 0.06 * 0.025
