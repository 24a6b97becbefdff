"""Lookup of patterns, finishes and textures at the surface point of a pixel (numba kernels).

Patterns are defined in the frame of their part, so they move with it; every value depends only on the point.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import inverse
from peopleboy.sim.cameras.imaging.camera_view import KELVIN_STEP, LIGHT_STEP
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.vectors import multiply
from peopleboy.sim.shapes.materials import TEXEL_STEP, PatternKind, Unrolling

_LEVEL, _ASLANT = int(Unrolling.LEVEL), int(Unrolling.ASLANT)


class PixelRun(NamedTuple):
    """Neighbouring pixels of one row that show the same part.

    Attributes:
        first, end: column of the first one, and that after the last one.
        part: number of the part.
        row: number of the row.
        depths: (W,) [m] depths of the row's pixels.
        matrices: (P, 3, 4) matrices of `part_from_pixel`.
    """

    first: int
    end: int
    part: int
    row: int
    depths: NDArray[np.float32]
    matrices: NDArray[np.float64]


@njit(cache=True, fastmath=True)
def painted(
    paint: NDArray[np.float64], texels: NDArray[np.int16], part: int, x: float, y: float, z: float
) -> tuple[float, float]:
    """Return temperature offset [K] and factor on light of a part's texture at a point [m] of the part.

    Values are interpolated linearly; beyond the edge the nearest texel is used.
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
    run: PixelRun,
    paint: NDArray[np.float64],
    texels: NDArray[np.int16],
    step: float,
) -> None:
    """Look up the texture at neighbouring pixels of one part, like `painted` at points.

    Most of the computation is shared by all pixels.

    Args:
        line: (W,) output, kelvin or factors on light of the pixels.
        run: the pixels.
        paint: (P, 7) table of `make_paint_table`.
        texels: (N,) one of its two layers.
        step: unit of the texels, `KELVIN_STEP` or `LIGHT_STEP`.
    """
    first, end, p, v, depths, matrices = run
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
        # An unsigned index avoids the check for negative indices.
        a, at = x - np.float32(i), np.uint32(texel + j * columns + i)
        value = np.float32(texels[at])
        lower = value + a * (np.float32(texels[at + one]) - value)
        at += np.uint32(columns)
        value = np.float32(texels[at])
        upper = value + a * (np.float32(texels[at + one]) - value)
        line[u] = unit * (lower + (y - np.float32(j)) * (upper - lower))


# Keeps the edges of patterns away from the faces of boxes, where rounding of coordinates may go either way.
_OFFSET = 0.137

# An odd polynomial fitted to atan(ratio) / 2 pi over 0..1.
_TURN_1, _TURN_3 = np.float32(0.15903002), np.float32(-0.0511187)
_TURN_5, _TURN_7 = np.float32(0.02328385), np.float32(-0.00620832)

_STRIPES = int(PatternKind.STRIPES)
_CHECKS = int(PatternKind.CHECKS)
_PATCH = int(PatternKind.PATCH)
_SPECKLE = int(PatternKind.SPECKLE)


def part_from_pixel(camera: Pinhole, world_from_camera: Matrix, world_from_part: Matrix) -> Matrix:
    """Combine camera and part poses so that a kernel reaches a part's frame in one product.

    Args:
        camera: the pinhole camera.
        world_from_camera: (4, 4) optical frame to world.
        world_from_part: (P, 4, 4).

    Returns:
        (P, 3, 4): the point of part p at pixel (u, v) and depth z is M[:, :3] @ (u z, v z, z) + M[:, 3].
    """
    matrices: Matrix = combine(rays_through(camera), world_from_camera, world_from_part)
    return matrices


@njit(cache=True, nogil=True)
def combine(rays: Matrix, world_from_camera: Matrix, world_from_part: Matrix) -> Matrix:
    """Do the same as `part_from_pixel`, with the camera's `rays_through`."""
    matrices, world_from_pixel = np.empty((len(world_from_part), 3, 4)), np.empty((3, 3))
    multiply(world_from_camera[:3, :3], rays, world_from_pixel)
    for part in range(len(world_from_part)):
        pose, matrix = world_from_part[part], matrices[part]
        multiply(pose[:3, :3].T, world_from_pixel, matrix[:, :3])
        x, y, z = (
            world_from_camera[0, 3] - pose[0, 3],
            world_from_camera[1, 3] - pose[1, 3],
            world_from_camera[2, 3] - pose[2, 3],
        )
        for i in range(3):
            matrix[i, 3] = pose[0, i] * x + pose[1, i] * y + pose[2, i] * z
    return matrices


@lru_cache(maxsize=16)
def rays_through(camera: Pinhole) -> Matrix:
    """Return the matrix M (3, 3) of pixel rays in the optical frame, M @ (u, v, 1)."""
    rays = inverse(camera.intrinsics)
    rays.setflags(write=False)
    return rays


@njit(cache=True, fastmath=True)
def surface_point(
    matrices: NDArray[np.float64], part: int, u: float | np.int32, v: float, z: float
) -> tuple[float, float, float]:
    """Return the point [m] in the part's frame at pixel (u, v) and depth z."""
    m, a, b = matrices, u * z, v * z
    return (
        m[part, 0, 0] * a + m[part, 0, 1] * b + m[part, 0, 2] * z + m[part, 0, 3],
        m[part, 1, 0] * a + m[part, 1, 1] * b + m[part, 1, 2] * z + m[part, 1, 3],
        m[part, 2, 0] * a + m[part, 2, 1] * b + m[part, 2, 2] * z + m[part, 2, 3],
    )


@njit(cache=True, fastmath=True)
def _wave(at: float) -> float:
    """Return a wave of period 1 in -1..1, made of parabolas: visually as smooth as a sine, and faster."""
    t = at - math.floor(at) - 0.5
    return 8.0 * t * (1.0 - 2.0 * abs(t))


@njit(cache=True, fastmath=True)
def smooth_variation(
    x: float, y: float, z: float, waves: float, phase: NDArray[np.float64], part: int
) -> float:
    """Return a smooth function of a point [m] of a part, in -1..1: crossed waves of a frequency [1/m]."""
    a = _wave(waves * (x + 0.6 * z) + phase[part, 0])
    b = _wave(waves * (y - 0.8 * x) + phase[part, 1])
    c = _wave(waves * 0.7 * (z + 0.5 * y) + phase[part, 2])
    return (a + b + c) / 3.0


@njit(cache=True, fastmath=True)
def pattern_value(
    kind: int, period: float, x: float, y: float, z: float, phase: NDArray[np.float64], part: int
) -> int:
    """Return 1 where the pattern's second value applies at a point [m] of a part, else 0."""
    if kind == _STRIPES:
        return math.floor(2.0 * z / period + _OFFSET) & 1
    if kind == _CHECKS:
        half = 2.0 / period
        return (
            math.floor(x * half + _OFFSET) + math.floor(y * half + _OFFSET) + math.floor(z * half + _OFFSET)
        ) & 1
    if kind == _PATCH:
        across, along = y / (0.35 * period), z / (0.5 * period)
        return int(x > 0.0 and across * across + along * along < 1.0)
    if kind == _SPECKLE:
        return int(smooth_variation(x, y, z, 1.0 / period, phase, part) > 0.15)
    return 0


@njit(cache=True, fastmath=True)
def turn_of(x: float, y: float) -> float:
    """Return the direction of (x, y) from +x towards +y, in turns 0..1, accurate to 0.00002 turns."""
    across, along = abs(y), abs(x)
    ratio = min(across, along) / max(max(across, along), 1e-9)
    square = ratio * ratio
    # An odd polynomial fitted to atan(ratio) / 2 pi over 0..1.
    turn = ratio * (0.15903002 + square * (-0.0511187 + square * (0.02328385 - 0.00620832 * square)))
    turn = 0.25 - turn if across > along else turn
    turn = 0.5 - turn if x < 0.0 else turn
    return 1.0 - turn if y < 0.0 else turn


@njit(cache=True, fastmath=True)
def finish_at(
    finish: NDArray[np.float64], texels: NDArray[np.int16], part: int, x: float, y: float, z: float
) -> tuple[float, float, float]:
    """Return kelvin, light and cover of a part's finish at a point [m] of the part.

    The nearest texel is used; it is larger than a pixel only at less than 2 m.
    """
    columns, rows = int(finish[part, 1]), int(finish[part, 2])
    column = int(turn_of(x, y) * columns + 0.5)
    row = int(min(max((z - finish[part, 3]) * finish[part, 4] + 0.5, 0.0), rows - 0.5))
    at = int(finish[part, 0]) + row * columns + (column if column < columns else 0)
    return TEXEL_STEP * texels[at, 0], TEXEL_STEP * texels[at, 1], TEXEL_STEP * texels[at, 2]


@njit(cache=True, fastmath=True, forceinline=True)
def finish_run(places: NDArray[np.uint32], run: PixelRun, finish: NDArray[np.float64]) -> None:
    """Find the texels of a finish at neighbouring pixels of one part, like `finish_at` at points.

    The indices are computed first, vectorised, and looked up afterwards, since memory access takes longest.

    Args:
        places: (W,) output, numbers of the pixels' texels.
        run: the pixels.
        finish: (P, 8) as in `MaterialTable`.
    """
    first, end, p, v, depths, matrices = run
    none, half, quarter = np.float32(0.0), np.float32(0.5), np.float32(0.25)
    one, tiny = np.float32(1.0), np.float32(1e-9)
    m, texel, columns, fine = matrices[p], np.int32(finish[p, 0]), np.int32(finish[p, 1]), finish[p, 4]
    around, most = np.float32(columns), np.float32(finish[p, 2] - 0.5)
    slope_x, start_x = np.float32(m[0, 0]), np.float32(m[0, 1] * v + m[0, 2])
    slope_y, start_y = np.float32(m[1, 0]), np.float32(m[1, 1] * v + m[1, 2])
    slope_z, start_z = np.float32(m[2, 0] * fine), np.float32((m[2, 1] * v + m[2, 2]) * fine)
    origin_x, origin_y = np.float32(m[0, 3]), np.float32(m[1, 3])
    origin_z = np.float32((m[2, 3] - finish[p, 3]) * fine + 0.5)
    for u in range(first, end):
        z = depths[u]
        x = (slope_x * np.float32(u) + start_x) * z + origin_x
        y = (slope_y * np.float32(u) + start_y) * z + origin_y
        across, along = abs(y), abs(x)
        ratio = min(across, along) / max(max(across, along), tiny)
        square = ratio * ratio
        turn = ratio * (_TURN_1 + square * (_TURN_3 + square * (_TURN_5 + _TURN_7 * square)))
        turn = quarter - turn if across > along else turn
        turn = half - turn if x < none else turn
        turn = one - turn if y < none else turn
        column = np.int32(turn * around + half)
        column = column if column < columns else np.int32(0)
        row = np.int32(min(max((slope_z * np.float32(u) + start_z) * z + origin_z, none), most))
        places[u] = texel + row * columns + column
