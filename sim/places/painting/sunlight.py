"""Where the sun gets in through windows, or falls between houses, and warms what it meets."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.places.extent import Extent
from peopleboy.sim.places.painting.fresco import Array, Fresco
from peopleboy.sim.places.place import Sun

_SOFT_TEXELS = 2
_INSIDE_M = 0.12  # a ray has left the room when it is so far behind the plane of a pane
_LEAST_M = 0.02  # what is nearer to a point than that is the point's own


def shine_on(fresco: Fresco, sun: Sun, panes: Sequence[Extent], blocking: Sequence[Extent]) -> None:
    """Warm and brighten what the sun reaches.

    Args:
        fresco: a floor, a wall or a road.
        sun: where it stands, and what it does.
        panes: windows through which it gets into a building; none where it is all open.
        blocking: what casts shadows.
    """
    way = _towards(sun)
    lit = np.ones(fresco.kelvin.shape, bool) if not panes else _through(fresco.world, way, panes)
    if blocking:
        _shade(lit, fresco.world, np.where(np.abs(way) < 1e-9, 1e-9, way), np.array(blocking))
    share = _softened(lit.astype(np.float64), _SOFT_TEXELS)
    warm = _softened(lit.astype(np.float64), max(round(0.12 / fresco.texel_m), 1))
    fresco.kelvin += sun.warms_k * warm * (1.0 + 0.12 * fresco.cloudy(0.4))
    fresco.light *= 1.0 + sun.brightens * share


def _towards(sun: Sun) -> Array:
    """(3,) from a surface to the sun."""
    return np.array(
        [
            math.cos(sun.elevation_rad) * math.cos(sun.azimuth_rad),
            math.cos(sun.elevation_rad) * math.sin(sun.azimuth_rad),
            math.sin(sun.elevation_rad),
        ]
    )


def _through(points: Array, way: Array, panes: Sequence[Extent]) -> NDArray[np.bool_]:
    """(H, W) whether the ray to the sun leaves through a pane."""
    lit = np.zeros(points.shape[:2], bool)
    for extent in panes:
        axis = int(np.argmin((extent[1] - extent[0])[:2]))
        if abs(way[axis]) < 1e-6:
            continue
        away = (extent[:, axis].mean() - points[..., axis]) / way[axis]
        at = points + away[..., None] * way
        others = [k for k in range(3) if k != axis]
        inside = np.all(
            (at[..., others] > extent[0, others]) & (at[..., others] < extent[1, others]), axis=-1
        )
        lit |= inside & (away > _INSIDE_M)
    return lit


@njit(cache=True)
def _shade(lit: NDArray[np.bool_], points: Array, way: Array, blocking: Array) -> None:
    """Take the light (H, W) from points (H, W, 3) whose rays meet a box of some (B, 2, 3) (slab method)."""
    for v in range(lit.shape[0]):
        for u in range(lit.shape[1]):
            for k in range(len(blocking)):
                if not lit[v, u]:
                    break
                near, far = -np.inf, np.inf
                for axis in range(3):
                    first = (blocking[k, 0, axis] - points[v, u, axis]) / way[axis]
                    second = (blocking[k, 1, axis] - points[v, u, axis]) / way[axis]
                    near, far = max(near, min(first, second)), min(far, max(first, second))
                lit[v, u] = near >= far or far <= _LEAST_M


def _softened(share: Array, texels: int) -> Array:
    """The mean over a square of texels about each, which a camera's edge and the sun's width ask for."""
    padded = np.pad(share, texels, mode="edge")
    for axis in (0, 1):
        total = np.cumsum(padded, axis=axis)
        zero = np.zeros_like(np.take(total, [0], axis))
        total = np.concatenate([zero, total], axis=axis)
        width = 2 * texels + 1
        upper = np.take(total, range(width, total.shape[axis]), axis)
        lower = np.take(total, range(total.shape[axis] - width), axis)
        padded = (upper - lower) / width
    return padded
