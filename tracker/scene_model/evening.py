"""Surfaces made even: a pixel's neighbours know its depth, too, where they are of one plane."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.scene import Metres

_RADIUS_PX: Final = 2


def evened(inverse: Metres, is_sure: NDArray[np.bool_], doubt: Metres) -> Metres:
    """Average inverse depths (H, W) [1/m] with those of their neighbours, as far as these are of one plane.

    Inverse depth is linear in the image on every plane, so that two neighbours on opposite sides of a pixel
    have its own on average. Pairs that do not, by their noise, lie across an edge or a fold: they are left
    out.

    Args:
        inverse: 0 where nothing is known.
        is_sure: (H, W) which pixels are averaged.
        doubt: (H, W) how far the mean of a pair may be off [1/m].
    """
    return np.asarray(_evened(inverse, is_sure, doubt))


@njit(cache=True, nogil=True)
def _evened(inverse, is_sure, doubt):  # type: ignore[no-untyped-def]
    height, width = inverse.shape
    found = inverse.copy()
    for v in range(height):
        for u in range(width):
            if not is_sure[v, u]:
                continue
            own, near = inverse[v, u], doubt[v, u]
            total, count = own, 1
            for down in range(min(_RADIUS_PX, v, height - 1 - v) + 1):
                reach = min(_RADIUS_PX, u, width - 1 - u)
                for across in range(1 if down == 0 else -reach, reach + 1):
                    one, other = (v - down, u - across), (v + down, u + across)
                    if is_sure[one] and is_sure[other]:
                        pair = 0.5 * (inverse[one] + inverse[other])
                        if abs(pair - own) < near:
                            total, count = total + 2.0 * pair, count + 2
            found[v, u] = total / count
    return found
