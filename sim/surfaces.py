"""Where on a surface a pixel falls, and what pattern and variation it finds there (numba kernels).

Patterns live in the frame of their part, so they move with it; every value depends on the point alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.camera import Camera, Matrix
from sim.looks import Look

# Keeps the edges of patterns away from the faces of boxes, whose coordinates round either way.
_OFFSET = 0.137


@dataclass(frozen=True, slots=True, eq=False)
class LookTable:
    """The looks of all P parts as arrays; row i belongs to part i.

    Attributes:
        thermal: (P, 5) temperature [degC], emissivity, variation [K], wave number [rad/m], contrast [K].
        colour: (P, 7) first and second reflectance, glow.
        kind: (P, 2) PatternKind of the thermal and of the colour pattern.
        period: (P, 2) [m] of the same.
        phase: (P, 3) [rad] offsets of the smooth variation.
    """

    thermal: NDArray[np.float64]
    colour: NDArray[np.float64]
    kind: NDArray[np.int64]
    period: NDArray[np.float64]
    phase: NDArray[np.float64]


def make_look_table(looks: Sequence[Look], rng: np.random.Generator) -> LookTable:
    """Put the looks of all parts into arrays; the generator draws each part's phase of variation."""
    return LookTable(
        thermal=np.array(
            [
                (k.temperature_c, k.emissivity, k.variation_k, 2.0 * math.pi / k.variation_m, k.contrast_k)
                for k in looks
            ]
        ).reshape(-1, 5),
        colour=np.array([(*k.rgb, *k.second_rgb, k.glow) for k in looks]).reshape(-1, 7),
        kind=np.array([(k.thermal_pattern.kind, k.colour_pattern.kind) for k in looks], np.int64).reshape(
            -1, 2
        ),
        period=np.array([(k.thermal_pattern.period_m, k.colour_pattern.period_m) for k in looks]).reshape(
            -1, 2
        ),
        phase=rng.uniform(0.0, 2.0 * math.pi, (len(looks), 3)),
    )


def part_from_pixel(camera: Camera, world_from_camera: Matrix, world_from_part: Matrix) -> Matrix:
    """Combine camera and part poses so that a kernel reaches a part's frame in one product.

    Args:
        camera: the pinhole camera.
        world_from_camera: (4, 4) optical frame to world.
        world_from_part: (P, 4, 4).

    Returns:
        (P, 3, 4): the point of part p at pixel (u, v) and depth z is M[:, :3] @ (u z, v z, z) + M[:, 3].
    """
    rays = np.linalg.inv(camera.intrinsics)
    rotation = np.swapaxes(world_from_part[:, :3, :3], 1, 2)
    matrices = np.empty((len(world_from_part), 3, 4))
    matrices[:, :, :3] = rotation @ (world_from_camera[:3, :3] @ rays)
    offset = world_from_camera[:3, 3] - world_from_part[:, :3, 3]
    matrices[:, :, 3] = np.einsum("pij,pj->pi", rotation, offset)
    return matrices


@njit(cache=True, fastmath=True, inline="always")
def surface_point(
    matrix: NDArray[np.float64], u: float, v: float, z: float
) -> tuple[float, float, float]:  # pragma: no cover
    """Return the point [m] in the part's frame that pixel (u, v) sees at depth z."""
    a, b = u * z, v * z
    x = matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * z + matrix[0, 3]
    y = matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * z + matrix[1, 3]
    w = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * z + matrix[2, 3]
    return x, y, w


@njit(cache=True, fastmath=True)
def smooth_variation(x: float, y: float, z: float, wave: float, phase: NDArray[np.float64]) -> float:
    """Return a smooth function of the point, within -1..1: three crossed waves."""
    a = math.sin(wave * (x + 0.6 * z) + phase[0])
    b = math.sin(wave * (y - 0.8 * x) + phase[1])
    c = math.sin(wave * 0.7 * (z + 0.5 * y) + phase[2])
    return (a + b + c) / 3.0


@njit(cache=True, fastmath=True)
def pattern_value(
    kind: int, period: float, x: float, y: float, z: float, phase: NDArray[np.float64]
) -> float:
    """Return 1 where the pattern's second value applies at a point of the part's frame, else 0."""
    if kind == 0:
        return 0.0
    if kind == 1:
        cell = z / period + _OFFSET
        return 1.0 if cell - math.floor(cell) < 0.5 else 0.0
    if kind == 2:
        half = 2.0 / period
        cells = (
            math.floor(x * half + _OFFSET) + math.floor(y * half + _OFFSET) + math.floor(z * half + _OFFSET)
        )
        return cells % 2.0
    if kind == 3:
        across, along = y / (0.35 * period), z / (0.5 * period)
        return 1.0 if x > 0.0 and across * across + along * along < 1.0 else 0.0
    return 1.0 if smooth_variation(x, y, z, 2.0 * math.pi / period, phase) > 0.15 else 0.0
