from __future__ import annotations

import numpy as np
import pytest

from benchmarks.speed.drone import SIZE, DroneWorld
from peopleboy.sim.physics.opengl import metric_depth


def test_the_drone_hovers_and_sees_itself_the_plane_and_a_block_a_metre_ahead() -> None:
    with DroneWorld() as world:
        for _ in range(20):
            world.step()
        colours, depth, parts = world.see()
    assert colours.shape == (*SIZE[::-1], 4)
    nothing, plane, block, drone = -1, 0, 1, 5
    assert (parts[0] == nothing).all()
    assert (parts[-1] == drone).all()
    assert (parts == plane).sum() > parts.size / 4
    ahead_m = metric_depth(depth, 0.0397, 1000.0)[parts == block]
    assert ahead_m == pytest.approx(np.full(ahead_m.shape, 0.95), abs=0.02)
    assert ahead_m.size
