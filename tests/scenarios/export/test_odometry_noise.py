import math

import numpy as np
import pytest

from peopleboy.scenarios.export.ros.odometry_noise import OdometryNoise
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M

NOISE_M = 0.005  # more than the robot's, and not so much that what is left out tells


def drives(advance_m: float, turn_rad: float, count: int) -> np.ndarray:
    """Poses (count, 3) that encoders with noise add up to, 60 steps on."""
    rng = np.random.default_rng(1)
    true = advance_m + np.array([-0.5, 0.5]) * turn_rad * WHEEL_DISTANCE_M
    x, y, heading = np.zeros((3, count))
    for _ in range(60):
        left, right = true[:, None] + NOISE_M * np.sqrt(np.abs(true))[:, None] * rng.normal(size=(2, count))
        turn, advance = (right - left) / WHEEL_DISTANCE_M, (left + right) / 2.0
        x, y = x + advance * np.cos(heading + turn / 2.0), y + advance * np.sin(heading + turn / 2.0)
        heading = heading + turn
    return np.stack([x, y, heading], axis=1)


@pytest.mark.parametrize(("advance_m", "turn_rad"), [(0.03, 0.0), (0.03, 0.02), (0.0, 0.05), (-0.02, -0.01)])
def test_the_covariance_is_that_of_many_drives(advance_m: float, turn_rad: float) -> None:
    noise, pose = OdometryNoise(NOISE_M), Planar(0.0, 0.0, 0.0)
    assert not noise.carry(pose).any()
    for _ in range(60):
        middle = pose.heading + turn_rad / 2.0
        heading = math.remainder(pose.heading + turn_rad, math.tau)
        pose = Planar(pose.x + advance_m * math.cos(middle), pose.y + advance_m * math.sin(middle), heading)
        covariance = noise.carry(pose)
    true = np.cov(drives(advance_m, turn_rad, 20_000).T)
    scale = np.sqrt(np.outer(np.diag(true), np.diag(true))) + 1e-9
    assert np.abs((covariance - true) / scale).max() < 0.06


def test_who_stands_stays_as_sure() -> None:
    noise = OdometryNoise(0.002)
    noise.carry(Planar(0.0, 0.0, 0.0))
    driven = noise.carry(Planar(1.0, 0.0, 0.0))
    # Both wheels have miscounted on 1 m.
    assert driven[0, 0] == pytest.approx(0.002**2 / 2.0)
    assert driven[2, 2] == pytest.approx(2.0 * 0.002**2 / WHEEL_DISTANCE_M**2)
    assert np.array_equal(noise.carry(Planar(1.0, 0.0, 0.0)), driven)
