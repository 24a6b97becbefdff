"""Closed forms agree with LAPACK up to rounding, and refuse what has no solution."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.small_matrices import (
    fit_line,
    inverse,
    mahalanobis2,
    principal_axes,
    solve,
    symmetric_eigen,
)

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS, st.sampled_from([2, 3]))
def test_inverses_and_solutions_agree_with_lapack(seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    matrices = rng.uniform(-1.0, 1.0, (5, size, size)) + 3.0 * np.eye(size)
    right = rng.normal(size=size)

    assert inverse(matrices) @ matrices == pytest.approx(
        np.broadcast_to(np.eye(size), matrices.shape), abs=1e-7
    )
    assert solve(matrices[0], right) == pytest.approx(np.linalg.solve(matrices[0], right), rel=1e-6, abs=1e-9)


@given(SEEDS)
def test_principal_axes_and_mahalanobis_distances_agree_with_lapack(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2, 2))
    covariance = root @ root.T + 0.01 * np.eye(2)
    difference = rng.normal(size=2)
    values, vectors = np.linalg.eigh(covariance)

    variances, angle = principal_axes(*covariance[[0, 0, 1], [0, 1, 1]].tolist())

    assert variances == pytest.approx(values[::-1], rel=1e-9)
    assert abs(np.dot(vectors[:, 1], [np.cos(angle), np.sin(angle)])) == pytest.approx(1.0, abs=1e-6)
    assert mahalanobis2(difference, covariance) == pytest.approx(
        difference @ np.linalg.solve(covariance, difference), rel=1e-6
    )


@given(SEEDS, st.integers(1, 3))
def test_eigenvectors_of_three_by_three_agree_with_lapack(seed: int, rank: int) -> None:
    rows = np.random.default_rng(seed).normal(size=(rank, 3))
    matrix = rows.T @ rows

    values, vectors = symmetric_eigen(matrix)

    assert values == pytest.approx(np.linalg.eigvalsh(matrix), rel=1e-9, abs=1e-12)
    assert vectors.T @ vectors == pytest.approx(np.eye(3), abs=1e-12)
    assert vectors @ np.diag(values) @ vectors.T == pytest.approx(matrix, abs=1e-12)


def test_a_line_is_fitted_as_by_polyfit() -> None:
    x = np.arange(20.0)
    y = 3.0 * x - 2.0 + np.sin(x)

    assert fit_line(x, y) == pytest.approx(np.polyfit(x, y, 1), rel=1e-12)


def test_singular_systems_are_refused() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        inverse(np.ones((2, 2)))
    with pytest.raises(np.linalg.LinAlgError):
        fit_line(np.ones(3), np.arange(3.0))
