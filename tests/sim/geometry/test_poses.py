import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from peopleboy.sim.geometry.poses import pose_matrices, quaternions


@given(seed=st.integers(0, 2**32 - 1), half_turns=st.booleans())
def test_quaternions_and_matrices_are_those_of_scipy(seed: int, half_turns: bool) -> None:
    rng = np.random.default_rng(seed)
    turns = Rotation.random(20, rng)
    if half_turns:
        axes = np.concatenate([np.eye(3), rng.normal(size=(5, 3))])
        turns = Rotation.from_rotvec(np.pi * axes / np.linalg.norm(axes, axis=1, keepdims=True))
    positions = rng.normal(size=(len(turns), 3))
    poses = pose_matrices(positions, turns.as_quat())
    np.testing.assert_allclose(poses[:, :3, :3], turns.as_matrix(), atol=1e-12)
    np.testing.assert_array_equal(poses[:, :3, 3], positions)
    np.testing.assert_array_equal(poses[:, 3], [[0.0, 0.0, 0.0, 1.0]] * len(turns))
    np.testing.assert_allclose(
        quaternions(poses), Rotation.from_matrix(poses[:, :3, :3]).as_quat(), atol=1e-15
    )
    np.testing.assert_array_equal(pose_matrices(positions[0], turns[0].as_quat()), poses[0])
