"""All paintings of a world as one table, and what they add where a pixel falls (a numba kernel)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.shapes.materials import Painting, Unrolling

_LEVEL, _ASLANT = int(Unrolling.LEVEL), int(Unrolling.ASLANT)
_STEPS = np.array([256.0, 4096.0])  # to a kelvin, and to a factor of 1 on light
KELVIN_STEP, LIGHT_STEP = 1.0 / _STEPS


def make_paint_table(
    paintings: Sequence[Painting | None],
) -> tuple[NDArray[np.float64], NDArray[np.int16]]:
    """Put the paintings of all P parts into arrays.

    Returns:
        (P, 7) first texel (-1 for a part without a painting), unrolling, origin across and up [m], texels a
        metre, columns, rows; and (2, N) texels: what is added [K / 256], factor on light [1 / 4096]. As whole
        numbers of two bytes they stay near to where they are looked up: waiting for memory takes longest.
    """
    rows = np.full((len(paintings), 7), -1.0)
    texels, first = [np.zeros((2, 0), np.int16)], 0
    for row, painting in zip(rows, paintings, strict=True):
        if painting is not None:
            height, width = painting.kelvin.shape
            row[:] = first, painting.unrolling, *painting.origin_m, 1.0 / painting.texel_m, width, height
            layers = np.stack([painting.kelvin.ravel(), painting.light.ravel()]) * _STEPS[:, None]
            texels.append(np.clip(np.rint(layers), -32768, 32767).astype(np.int16))
            first += height * width
    return rows, np.concatenate(texels, axis=1)


@njit(cache=True, fastmath=True)
def painted(
    paint: NDArray[np.float64], texels: NDArray[np.int16], part: int, x: float, y: float, z: float
) -> tuple[float, float]:
    """Return what the painting of a part adds [K], and its factor on light, at a point [m] of the part.

    Between the middles of texels it is linear; beyond the edge the nearest texel counts.
    """
    across, up = (x, y) if int(paint[part, 1]) == _LEVEL else (x + y, z)
    if int(paint[part, 1]) == _ASLANT:
        up += 0.5 * (x - y)
    columns, rows = int(paint[part, 5]), int(paint[part, 6])
    u = min(max((across - paint[part, 2]) * paint[part, 4], 0.0), columns - 1.001)
    v = min(max((up - paint[part, 3]) * paint[part, 4], 0.0), rows - 1.001)
    left, low = int(u), int(v)
    a, b = u - left, v - low
    at = int(paint[part, 0]) + low * columns + left
    c, d, e, f = (1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b
    above = at + columns
    kelvin, light = texels[0], texels[1]
    return (
        KELVIN_STEP * (c * kelvin[at] + d * kelvin[at + 1] + e * kelvin[above] + f * kelvin[above + 1]),
        LIGHT_STEP * (c * light[at] + d * light[at + 1] + e * light[above] + f * light[above + 1]),
    )


@njit(cache=True, fastmath=True, forceinline=True)
def paint_run(
    line: NDArray[np.float32],
    first: int,
    end: int,
    v: int,
    p: int,
    depths: NDArray[np.float32],
    matrices: NDArray[np.float64],
    paint: NDArray[np.float64],
    texels: NDArray[np.int16],
    step: float,
) -> None:
    """Find what a painting does to neighbouring pixels of one part, as `painted` says it of points.

    They share nearly all that is to be reckoned.

    Args:
        line: (W,) gets kelvin or factors on light of pixels first..end-1.
        first: column of the first pixel.
        end: column after the last one.
        v: number of the row.
        p: number of the part.
        depths: (W,) [m] how far away what the row's pixels see is.
        matrices: (P, 3, 4) as `part_from_pixel` gives them.
        paint: (P, 7) as `make_paint_table` gives them.
        texels: (N,) one of both layers beside them.
        step: what a unit of it means, `KELVIN_STEP` or `LIGHT_STEP`.
    """
    unit, none, one = np.float32(step), np.float32(0.0), np.uint32(1)
    scale, columns, texel = paint[p, 4], np.int32(paint[p, 5]), np.int32(paint[p, 0])
    most_u, most_v = np.float32(paint[p, 5] - 1.001), np.float32(paint[p, 6] - 1.001)
    m, is_level = matrices[p], int(paint[p, 1]) == _LEVEL
    low, more = (1, 0.0) if is_level else (2, 1.0)
    lean = 0.5 if int(paint[p, 1]) == _ASLANT else 0.0
    # Texels across are (slope u + start) z + origin, and those up alike.
    slope_u = np.float32((m[0, 0] + more * m[1, 0]) * scale)
    start_u = np.float32(((m[0, 1] + more * m[1, 1]) * v + m[0, 2] + more * m[1, 2]) * scale)
    origin_u = np.float32((m[0, 3] + more * m[1, 3] - paint[p, 2]) * scale)
    slope_v = np.float32((m[low, 0] + lean * (m[0, 0] - m[1, 0])) * scale)
    start_v = np.float32(
        ((m[low, 1] + lean * (m[0, 1] - m[1, 1])) * v + m[low, 2] + lean * (m[0, 2] - m[1, 2])) * scale
    )
    origin_v = np.float32((m[low, 3] + lean * (m[0, 3] - m[1, 3]) - paint[p, 3]) * scale)
    for u in range(first, end):
        z = depths[u]
        x = min(max((slope_u * np.float32(u) + start_u) * z + origin_u, none), most_u)
        y = min(max((slope_v * np.float32(u) + start_v) * z + origin_v, none), most_v)
        i, j = np.int32(x), np.int32(y)
        # An unsigned place is not checked for being counted from the end.
        a, at = x - np.float32(i), np.uint32(texel + j * columns + i)
        value = np.float32(texels[at])
        lower = value + a * (np.float32(texels[at + one]) - value)
        at += np.uint32(columns)
        value = np.float32(texels[at])
        upper = value + a * (np.float32(texels[at + one]) - value)
        line[u] = unit * (lower + (y - np.float32(j)) * (upper - lower))
