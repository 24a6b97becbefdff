"""Sunlight through windows or between houses, and heat traces of things on surfaces."""

import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.places.extent import Extent
from peopleboy.sim.places.place import Sun
from peopleboy.sim.places.textures.surface_texture import Array, SurfaceTexture
from peopleboy.sim.shapes.materials import Unrolling

_SOFT_TEXELS = 2
_INSIDE_M = 0.12  # distance behind the plane of a pane at which a ray has left the room
_LEAST_M = 0.02  # nearer obstacles belong to the surface itself


def shine_on(texture: SurfaceTexture, sun: Sun, panes: Sequence[Extent], blocking: Sequence[Extent]) -> None:
    """Warm and brighten sunlit points of a surface.

    Args:
        texture: a floor, a wall or a road.
        sun: position and effects of the sun.
        panes: windows through which it enters a building; none outdoors.
        blocking: boxes that cast shadows.
    """
    way = _towards(sun)
    lit = np.ones(texture.kelvin.shape, bool) if not panes else _through(texture.world, way, panes)
    if blocking:
        _shade(lit, texture.world, np.where(np.abs(way) < 1e-9, 1e-9, way), np.array(blocking))
    share = _softened(lit.astype(np.float64), _SOFT_TEXELS)
    warm = _softened(lit.astype(np.float64), max(round(0.12 / texture.texel_m), 1))
    texture.kelvin += sun.warms_k * warm * (1.0 + 0.12 * texture.cloudy(0.4))
    texture.light *= 1.0 + sun.brightens * share


def _towards(sun: Sun) -> Array:
    """Return the direction (3,) to the sun."""
    return np.array(
        [
            math.cos(sun.elevation_rad) * math.cos(sun.azimuth_rad),
            math.cos(sun.elevation_rad) * math.sin(sun.azimuth_rad),
            math.sin(sun.elevation_rad),
        ]
    )


def _through(points: Array, way: Array, panes: Sequence[Extent]) -> NDArray[np.bool_]:
    """Return (H, W) whether the ray to the sun leaves through a pane."""
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
    """Remove the light (H, W) of points (H, W, 3) whose rays hit a box of (B, 2, 3) (slab method)."""
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
                    if near >= far or far <= _LEAST_M:  # further axes only bring them closer
                        break
                lit[v, u] = near >= far or far <= _LEAST_M


def _softened(share: Array, texels: int) -> Array:
    """Return the mean over a square of texels, for the penumbra of the sun."""
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


# Effects of warm and cold objects on nearby surfaces.

_LEAST_K = 2.0  # smaller temperature differences from a surface have no effect
_REACH_M, _NEAR_M = 0.6, 0.14
_FRAME_M, _DRAUGHT_K = 0.08, 2.0
_STEP = 8  # step in texels for finding the neighbourhood of an object
_PLUME_SHARE, _TOUCH_SHARE, _PLUME_M = 0.13, 0.12, 0.9


def warm_by(texture: SurfaceTexture, surface_c: float, things: Sequence[tuple[Extent, float]]) -> None:
    """Add the effects of objects with given extents [m] and temperatures [degC] to a surface.

    A nearby surface takes on a share of the temperature difference, which decreases with distance. Above a
    warm object a plume rises along the wall, widening and fading; below a cold pane cold air falls.
    """
    for extent, temperature in things:
        difference = temperature - surface_c
        if abs(difference) > _LEAST_K:
            _touch(texture, extent, difference)


def frame_doors(texture: SurfaceTexture, doorways: Sequence[Extent]) -> None:
    """Add frames around doors, darker than walls, and cold air below them."""
    for extent in doorways:
        gap = np.maximum(np.maximum(extent[0] - texture.world, texture.world - extent[1]), 0.0)
        away = np.linalg.norm(gap, axis=-1)
        is_wall = texture.unrolling == Unrolling.UPRIGHT
        frame = is_wall * np.clip((_FRAME_M - away) / texture.texel_m + 0.5, 0.0, 1.0)
        texture.kelvin += 0.7 * frame - _DRAUGHT_K * np.exp(
            -((away / 0.35) ** 2) - texture.world[..., 2] / 0.15
        )
        texture.light *= 1.0 - 0.4 * frame


def _touch(texture: SurfaceTexture, extent: Extent, difference: float) -> None:
    rows, columns = _near(texture.world, extent)
    if not rows.any() or not columns.any():
        return
    box = np.ix_(rows, columns)
    points = texture.world[box]
    gap = np.maximum(np.maximum(extent[0] - points, points - extent[1]), 0.0)
    share = _TOUCH_SHARE * np.exp(-((np.linalg.norm(gap, axis=-1) / _NEAR_M) ** 2))
    rise = points[..., 2] - extent[1, 2] if difference > 0.0 else extent[0, 2] - points[..., 2]
    wide = _NEAR_M + 0.15 * np.maximum(rise, 0.0)
    plume = np.exp(-np.maximum(rise, 0.0) / _PLUME_M - (np.hypot(gap[..., 0], gap[..., 1]) / wide) ** 2)
    share = share + _PLUME_SHARE * plume * (rise > 0.0)
    texture.kelvin[box] += np.clip(difference, -12.0, 60.0) * share


def _near(world: Array, extent: Extent) -> tuple[Array, Array]:
    """Return the rows and columns of a texture that are near, above or below an object."""
    coarse = world[::_STEP, ::_STEP]
    near = np.all(
        (coarse[..., :2] > extent[0, :2] - _REACH_M) & (coarse[..., :2] < extent[1, :2] + _REACH_M), axis=-1
    )
    near &= (coarse[..., 2] > extent[0, 2] - 2.5) & (coarse[..., 2] < extent[1, 2] + 3.0)
    rows, columns = (np.repeat(near.any(axis=axis), _STEP) for axis in (1, 0))
    return rows[: world.shape[0]], columns[: world.shape[1]]
