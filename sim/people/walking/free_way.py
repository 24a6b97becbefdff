"""Whether walls and things stand between two points of the floor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def is_free(start: Array, end: Array, walls: Array, margin_m: float = 0.0) -> bool:
    """Tell whether a straight line keeps clear of all rectangles.

    One in which the line starts is passed over, such as the chair that somebody sits on, and to one that is
    nearer to the start than the margin the line may come as near as it is at the start.

    Args:
        start: (2,) [m].
        end: (2,) [m].
        walls: (K, 4) [m] min_x, min_y, max_x, max_y.
        margin_m: [m] clearance to keep.
    """
    if not len(walls):
        return True
    low, high = walls[:, :2], walls[:, 2:]
    gaps = np.linalg.norm(np.maximum(np.maximum(low - start, start - high), 0.0), axis=1)  # (K,)
    margin = np.minimum(margin_m, 0.9 * gaps)[:, None]
    way = end - start
    safe = np.where(np.abs(way) < 1e-9, 1e-9, way)
    near, far = (low - margin - start) / safe, (high + margin - start) / safe  # (K, 2)
    first = np.minimum(near, far).max(axis=1)
    last = np.maximum(near, far).min(axis=1)
    is_hit = (gaps > 0.0) & (np.maximum(first, 0.0) < np.minimum(last, 1.0))
    return not bool(is_hit.any())
