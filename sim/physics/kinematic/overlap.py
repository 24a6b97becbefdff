"""How deep a rectangle and a convex outline with a radius are in each other (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from peopleboy.sim.physics.solids.solids import Array

_FLUSH_M = 1e-3  # corners no farther back than that bear, too
APART = (-math.inf, 0.0, 0.0, 0.0)


@njit(cache=True)
def overlap(half: Array, outline: Array, radius: float) -> tuple[float, float, float, float]:
    """Tell depth, normal and lever of a contact.

    Args:
        half: (2,) [m] half lengths of a rectangle about the origin, along x and y.
        outline: (N, 2) [m] counter-clockwise corners of the other, in the rectangle's frame.
        radius: [m] by which it is wider.

    Returns:
        depth [m], negative when they are apart; the unit normal x, y, from the outline to the rectangle; and
        where along (-y, x) of that normal they bear on each other [m].
    """
    separation, nx, ny = _widest_gap(half, outline)
    if separation > radius:
        return APART
    if separation > 1e-9:
        distance, x, y = _nearest(half, outline)
        if distance > 1e-9:
            separation, nx, ny = distance, x, y
    return radius - separation, nx, ny, _bearing(half, outline, nx, ny)


@njit(cache=True)
def _widest_gap(half: Array, outline: Array) -> tuple[float, float, float]:
    """The greatest gap along a normal of either's sides, negative if they overlap, and that normal."""
    best, best_x, best_y = -math.inf, 0.0, 0.0
    count = len(outline)
    for axis in range(2):
        for sign in (-1.0, 1.0):
            gap = sign * outline[0, axis]
            for k in range(1, count):
                gap = min(gap, sign * outline[k, axis])
            gap -= half[axis]
            if gap > best:
                best, best_x, best_y = gap, -sign if axis == 0 else 0.0, -sign if axis == 1 else 0.0
    for k in range(count if count > 1 else 0):
        a, b = outline[k], outline[(k + 1) % count]
        x, y = b[1] - a[1], a[0] - b[0]
        length = math.hypot(x, y)
        if length > 1e-9:
            x, y = x / length, y / length
            gap = -abs(x) * half[0] - abs(y) * half[1] - x * a[0] - y * a[1]
            if gap > best:
                best, best_x, best_y = gap, x, y
    return best, best_x, best_y


@njit(cache=True)
def _nearest(half: Array, outline: Array) -> tuple[float, float, float]:
    """The distance of two that are apart, and the direction to the rectangle."""
    best, best_x, best_y = math.inf, 0.0, 0.0
    count = len(outline)
    for k in range(count):
        a, b = outline[k], outline[(k + 1) % count]
        x, y = min(max(a[0], -half[0]), half[0]) - a[0], min(max(a[1], -half[1]), half[1]) - a[1]
        if math.hypot(x, y) < best:
            best, best_x, best_y = math.hypot(x, y), x, y
        along_x, along_y = b[0] - a[0], b[1] - a[1]
        square = along_x * along_x + along_y * along_y
        for corner in range(4 if square > 0.0 else 0):
            cx, cy = half[0] if corner & 1 else -half[0], half[1] if corner & 2 else -half[1]
            share = ((cx - a[0]) * along_x + (cy - a[1]) * along_y) / square
            share = min(max(share, 0.0), 1.0)
            x, y = cx - a[0] - share * along_x, cy - a[1] - share * along_y
            if math.hypot(x, y) < best:
                best, best_x, best_y = math.hypot(x, y), x, y
    return (best, best_x / best, best_y / best) if best > 1e-9 else (best, 0.0, 0.0)


@njit(cache=True)
def _bearing(half: Array, outline: Array, nx: float, ny: float) -> float:
    """The middle of where the sides that face each other lie side by side, along (-ny, nx)."""
    corners = np.empty((4, 2))
    for k in range(4):
        corners[k, 0] = half[0] if k & 1 else -half[0]
        corners[k, 1] = half[1] if k & 2 else -half[1]
    a, b = _foremost(corners, -1.0, nx, ny)
    c, d = _foremost(outline, 1.0, nx, ny)
    low, high = max(a, c), min(b, d)
    if low <= high:
        return (low + high) / 2.0
    return b if c > b else a


@njit(cache=True)
def _foremost(points: Array, way: float, nx: float, ny: float) -> tuple[float, float]:
    """Least and greatest place along (-ny, nx) of the points that lie farthest along `way` times (nx, ny)."""
    most = -math.inf
    for k in range(len(points)):
        most = max(most, way * (nx * points[k, 0] + ny * points[k, 1]))
    low, high = math.inf, -math.inf
    for k in range(len(points)):
        if way * (nx * points[k, 0] + ny * points[k, 1]) >= most - _FLUSH_M:
            at = nx * points[k, 1] - ny * points[k, 0]
            low, high = min(low, at), max(high, at)
    return low, high
