"""What warm and cold things do to the surfaces about them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from peopleboy.sim.places.extent import Extent
from peopleboy.sim.places.painting.fresco import Array, Fresco
from peopleboy.sim.shapes.materials import Unrolling

_LEAST_K = 2.0  # a thing that differs less from a surface leaves no trace
_REACH_M, _NEAR_M = 0.6, 0.14
_FRAME_M, _DRAUGHT_K = 0.08, 2.0
_STEP = 8  # texels between those by which a thing's neighbourhood is found
_PLUME_SHARE, _TOUCH_SHARE, _PLUME_M = 0.13, 0.12, 0.9


def warm_by(fresco: Fresco, surface_c: float, things: Sequence[tuple[Extent, float]]) -> None:
    """Add what things of known extents [m] and temperatures [degC] do to a surface.

    Near it, a surface takes a share of the difference that falls off with the distance. Above a warm thing
    rises a plume along the wall, which widens and fades; below a cold pane cold air falls.
    """
    for extent, temperature in things:
        difference = temperature - surface_c
        if abs(difference) > _LEAST_K:
            _touch(fresco, extent, difference)


def frame_doors(fresco: Fresco, doorways: Sequence[Extent]) -> None:
    """Put frames about doors, darker than walls, and let cold air in below them."""
    for extent in doorways:
        gap = np.maximum(np.maximum(extent[0] - fresco.world, fresco.world - extent[1]), 0.0)
        away = np.linalg.norm(gap, axis=-1)
        is_wall = fresco.unrolling == Unrolling.UPRIGHT
        frame = is_wall * np.clip((_FRAME_M - away) / fresco.texel_m + 0.5, 0.0, 1.0)
        fresco.kelvin += 0.7 * frame - _DRAUGHT_K * np.exp(
            -((away / 0.35) ** 2) - fresco.world[..., 2] / 0.15
        )
        fresco.light *= 1.0 - 0.4 * frame


def _touch(fresco: Fresco, extent: Extent, difference: float) -> None:
    rows, columns = _near(fresco.world, extent)
    if not rows.any() or not columns.any():
        return
    box = np.ix_(rows, columns)
    points = fresco.world[box]
    gap = np.maximum(np.maximum(extent[0] - points, points - extent[1]), 0.0)
    share = _TOUCH_SHARE * np.exp(-((np.linalg.norm(gap, axis=-1) / _NEAR_M) ** 2))
    rise = points[..., 2] - extent[1, 2] if difference > 0.0 else extent[0, 2] - points[..., 2]
    wide = _NEAR_M + 0.15 * np.maximum(rise, 0.0)
    plume = np.exp(-np.maximum(rise, 0.0) / _PLUME_M - (np.hypot(gap[..., 0], gap[..., 1]) / wide) ** 2)
    share = share + _PLUME_SHARE * plume * (rise > 0.0)
    fresco.kelvin[box] += np.clip(difference, -12.0, 60.0) * share


def _near(world: Array, extent: Extent) -> tuple[Array, Array]:
    """Which rows and columns of a fresco come near a thing, or lie above or below it."""
    coarse = world[::_STEP, ::_STEP]
    near = np.all(
        (coarse[..., :2] > extent[0, :2] - _REACH_M) & (coarse[..., :2] < extent[1, :2] + _REACH_M), axis=-1
    )
    near &= (coarse[..., 2] > extent[0, 2] - 2.5) & (coarse[..., 2] < extent[1, 2] + 3.0)
    rows, columns = (np.repeat(near.any(axis=axis), _STEP) for axis in (1, 0))
    return rows[: world.shape[0]], columns[: world.shape[1]]
