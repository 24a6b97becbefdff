"""Closed forms for 2 x 2 and 3 x 3 systems, whose results have the same bits with every LAPACK.

`np.linalg` passes such systems to the LAPACK that NumPy was built with, whose last bits change from one
version to the next. A closed loop amplifies them to millimetres within a minute.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_SWEEPS: Final = 12  # of Jacobi rotations; four are enough for full precision, as they converge quadratically


def inverse(matrix: Floats) -> Floats:
    """Return the inverses of matrices (..., 2, 2) or (..., 3, 3), by cofactors.

    Raises:
        LinAlgError: a matrix is singular.
    """
    m = np.asarray(matrix, np.float64)
    adjugate = np.empty_like(m)
    if m.shape[-1] == 2:
        adjugate[..., 0, 0], adjugate[..., 0, 1] = m[..., 1, 1], -m[..., 0, 1]
        adjugate[..., 1, 0], adjugate[..., 1, 1] = -m[..., 1, 0], m[..., 0, 0]
    else:
        for i in range(3):
            for j in range(3):
                a, b, c, d = (j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3
                adjugate[..., i, j] = m[..., a, c] * m[..., b, d] - m[..., a, d] * m[..., b, c]
    determinant = m[..., 0, 0] * adjugate[..., 0, 0]
    for k in range(1, m.shape[-1]):
        determinant = determinant + m[..., 0, k] * adjugate[..., k, 0]
    if np.any(determinant == 0.0):
        raise np.linalg.LinAlgError("Singular matrix")
    return np.asarray(adjugate / determinant[..., None, None])


def solve(matrix: Floats, right: Floats) -> Floats:
    """Return x (n,) with matrix (n, n) @ x = right (n,), for n = 2 or 3.

    Raises:
        LinAlgError: the matrix is singular.
    """
    # Sums in a fixed order, and not the matrix product of BLAS.
    return np.asarray((inverse(matrix) * right).sum(axis=-1))


def mahalanobis2(difference: Floats, covariance: Floats) -> float:
    """Return the squared Mahalanobis distance of a difference (2,) under a covariance (2, 2).

    Raises:
        LinAlgError: the covariance is singular.
    """
    along, across = solve(covariance, difference).tolist()
    return float(difference[0] * along + difference[1] * across)


def principal_axes(xx: float, xy: float, yy: float) -> tuple[tuple[float, float], float]:
    """Return the variances along the principal axes of a covariance, the larger first.

    Returns:
        variances: (2,) along the major and the minor axis.
        angle: [rad] from x to the major axis.
    """
    middle, radius = (xx + yy) / 2.0, math.hypot((xx - yy) / 2.0, xy)
    return (middle + radius, middle - radius), math.atan2(2.0 * xy, xx - yy) / 2.0


def symmetric_eigen(matrix: Floats) -> tuple[Floats, Floats]:
    """Return ascending eigenvalues and the eigenvectors of a symmetric matrix (3, 3), by Jacobi rotations.

    Returns:
        values: (3,).
        vectors: (3, 3), in columns.

    Source: Golub and Van Loan, Matrix Computations, section 8.5.
    """
    values, vectors = np.array(matrix, np.float64), np.eye(3)
    for _ in range(_SWEEPS):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if values[p, q] == 0.0:
                continue
            half = float(values[q, q] - values[p, p]) / (2.0 * float(values[p, q]))
            tangent = math.copysign(1.0, half) / (abs(half) + math.hypot(1.0, half))
            cosine = 1.0 / math.hypot(1.0, tangent)
            sine = tangent * cosine
            for rows in (values, values.T, vectors.T):  # J' A J, and V J
                one, other = rows[p].copy(), rows[q].copy()
                rows[p], rows[q] = cosine * one - sine * other, sine * one + cosine * other
            values[p, q] = values[q, p] = 0.0
    order = np.argsort(values.diagonal())
    return values.diagonal()[order], vectors[:, order]


def fit_line(x: Floats, y: Floats) -> tuple[float, float]:
    """Return slope and offset of the line y = slope x + offset through points (N,), by least squares.

    Raises:
        LinAlgError: all x are equal.
    """
    middle_x, middle_y = float(x.mean()), float(y.mean())
    away = x - middle_x
    spread = float(np.square(away).sum())
    if spread == 0.0:
        raise np.linalg.LinAlgError("all x are equal")
    slope = float((away * (y - middle_y)).sum()) / spread
    return slope, middle_y - slope * middle_x
