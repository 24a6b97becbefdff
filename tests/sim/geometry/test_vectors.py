from fractions import Fraction

import numpy as np
from numba import njit

from peopleboy.sim.geometry.pinhole import invert_pose
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.geometry.vectors import fma, from_each, invert


def poses(count):
    rng = np.random.default_rng(0)
    turns = rng.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return pose_matrices(5.0 * rng.normal(size=(count, 3)), turns)


def test_a_fused_sum_is_rounded_once() -> None:
    fused = njit(lambda a, b, c: fma(a, b, c))
    rng = np.random.default_rng(1)
    for a, b in rng.normal(size=(50, 2)):
        c = -a * b  # so that all that is left is what the product is rounded by
        assert fused(a, b, c) == float(Fraction(a) * Fraction(b) + Fraction(c))


def test_products_and_inverses_are_those_of_linear_algebra() -> None:
    first, *others = poses(9)
    inverse = np.empty((4, 4))
    invert(first, inverse)
    np.testing.assert_allclose(inverse, invert_pose(first), rtol=0.0, atol=1e-14)
    found = from_each(inverse, np.array(others))
    np.testing.assert_allclose(found, inverse @ np.array(others), rtol=0.0, atol=1e-14)
