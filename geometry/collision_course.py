"""Collision courses of discs that keep their velocities."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def times_to_collision(gaps: Floats, velocities: Floats, reach_m: float | Floats) -> Floats:
    """Return the times after which pairs of discs touch at constant velocities.

    Args:
        gaps: (Q, 2) [m] from the centre of the first disc to that of the second.
        velocities: (Q, 2) [m/s] of the second disc relative to the first.
        reach_m: [m] sum of the radii, also one per pair (Q,).

    Returns:
        (Q,) [s] the smaller root of |gap + t velocity| = reach_m; 0 while they overlap, inf if they never
        touch.
    """
    a, b = _products(velocities, velocities), _products(gaps, velocities)
    c = _products(gaps, gaps) - reach_m**2
    inner = b * b - a * c
    touches = (a > 0.0) & (b < 0.0) & (inner >= 0.0)
    roots = c / (np.sqrt(np.where(touches, inner, 1.0)) - np.where(touches, b, 0.0))
    return np.where(c <= 0.0, 0.0, np.where(touches, roots, np.inf))


def _products(one: Floats, other: Floats) -> Floats:
    """Return the scalar products (Q,) of vectors (Q, 2)."""
    products: Floats = (one[:, None, :] @ other[:, :, None])[:, 0, 0]
    return products
