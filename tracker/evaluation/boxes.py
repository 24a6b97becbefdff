"""Areas and overlaps of boxes; a box is left, top, width, height in pixels."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def area(box: Floats) -> Floats:
    """Give the areas (...) [px^2] of boxes (..., 4)."""
    return np.asarray(box[..., 2] * box[..., 3])


def intersection(a: Floats, b: Floats) -> Floats:
    """Give the areas (...) [px^2] that boxes a (..., 4) and b (..., 4) share; leading axes broadcast."""
    near = np.maximum(a[..., :2], b[..., :2])
    far = np.minimum(a[..., :2] + a[..., 2:], b[..., :2] + b[..., 2:])
    side = np.maximum(far - near, 0.0)
    return np.asarray(side[..., 0] * side[..., 1])


def iou(a: Floats, b: Floats) -> Floats:
    """Give intersection over union (...) of boxes a (..., 4) and b (..., 4); leading axes broadcast.

    Symmetric, in 0..1; 1 for a box with itself, 0 where either box has no area.
    """
    shared = intersection(a, b)
    return cover(shared, area(a) + area(b) - shared)


def cover(shared: Floats, whole: Floats) -> Floats:
    """Give the shares (...) shared / whole, at most 1, and 0 where there is no whole to cover."""
    ratio = np.divide(shared, whole, out=np.zeros_like(shared), where=whole > 0.0)
    return np.minimum(ratio, 1.0)
