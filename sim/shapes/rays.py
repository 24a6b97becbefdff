"""Intersection of one ray with one shape, in the shape's frame (numba kernels).

A hit is the number t at which the ray o + t d enters the shape, and the surface of the shape, numbered as in
`ShapeTable`; t is infinite for a miss. As in `raycast`, shapes are visible from outside only. Meshes are not
supported: they are always missed.
"""

import math

from numba import njit

from peopleboy.sim.geometry.vectors import Point, dot
from peopleboy.sim.shapes.shapes import ShapeKind

Hit = tuple[float, int]

MISS: Hit = (math.inf, 0)

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_PLANE = int(ShapeKind.PLANE)


@njit(cache=True, error_model="numpy")
def hit_shape(kind: int, size: Point, o: Point, d: Point) -> Hit:
    """Return the hit of a ray on a shape.

    Args:
        kind: ShapeKind.
        size: as in `Shape`.
        o: origin of the ray, in the shape's frame.
        d: direction of the ray; not necessarily a unit vector.
    """
    if kind == _BOX:
        return _hit_box(size, o, d)
    if kind == _CAPSULE:
        return _hit_capsule(size[0] / 2.0, size[1], o, d)
    if kind == _SPHERE:
        return _hit_ball(0.0, size[0], o, d), 0
    if kind == _CYLINDER:
        return _hit_cylinder(size[0] / 2.0, size[1], o, d)
    if kind == _PLANE and o[2] > 0.0 and d[2] < 0.0:
        return -o[2] / d[2], 0
    return MISS


@njit(cache=True, error_model="numpy")
def _first_root(a: float, b: float, c: float) -> float:
    """Return the smaller root of a t^2 + 2 b t + c if the function first becomes negative there for t > 0."""
    square = b * b - a * c
    if c <= 0.0 or b >= 0.0 or square < 0.0:
        return math.inf
    return c / (math.sqrt(square) - b)


@njit(cache=True, error_model="numpy")
def _hit_ball(height: float, radius: float, o: Point, d: Point) -> float:
    """Return the hit on a ball with its centre at a height on the z axis."""
    p = (o[0], o[1], o[2] - height)
    return _first_root(dot(d, d), dot(p, d), dot(p, p) - radius * radius)


@njit(cache=True, error_model="numpy")
def _hit_tube(half: float, radius: float, o: Point, d: Point) -> float:
    """Return the hit on the round side of a cylinder along z."""
    t = _first_root(
        d[0] * d[0] + d[1] * d[1], o[0] * d[0] + o[1] * d[1], o[0] * o[0] + o[1] * o[1] - radius * radius
    )
    return t if abs(o[2] + t * d[2]) <= half else math.inf


@njit(cache=True, error_model="numpy")
def _hit_capsule(half: float, radius: float, o: Point, d: Point) -> Hit:
    """Return the hit on a capsule: that on the infinite tube, or beyond an end that on the end's ball.

    Source: Quilez, Intersectors (iquilezles.org/articles/intersectors), capIntersect.
    """
    a, b = d[0] * d[0] + d[1] * d[1], o[0] * d[0] + o[1] * d[1]
    square = b * b - a * (o[0] * o[0] + o[1] * o[1] - radius * radius)
    if square < 0.0:
        return MISS
    height = o[2]
    if a > 0.0:
        t = (-b - math.sqrt(square)) / a
        height += t * d[2]
        if abs(height) <= half:
            return (t, 0) if t > 0.0 else MISS
    else:
        height = -d[2]
    if height < 0.0:
        return _hit_ball(-half, radius, o, d), 1
    return _hit_ball(half, radius, o, d), 2


@njit(cache=True, error_model="numpy")
def _hit_cylinder(half: float, radius: float, o: Point, d: Point) -> Hit:
    t, surface = _hit_tube(half, radius, o, d), 0
    sign = -1.0 if o[2] < 0.0 else 1.0
    if sign * o[2] > half and sign * d[2] < 0.0:
        lid = (sign * half - o[2]) / d[2]
        x, y = o[0] + lid * d[0], o[1] + lid * d[1]
        if x * x + y * y <= radius * radius and lid < t:
            t, surface = lid, 2 if sign > 0.0 else 1
    return t, surface


@njit(cache=True, error_model="numpy")
def _hit_box(size: Point, o: Point, d: Point) -> Hit:
    """Return the hit on a box by the slab method: the ray enters the last slab before it leaves any."""
    enter, leave, surface = 0.0, math.inf, -1
    for i in range(3):
        half = 0.5 * size[i]
        if d[i] == 0.0:
            if abs(o[i]) > half:
                return MISS
            continue
        step = 1.0 / d[i]
        middle, wide = -o[i] * step, half * abs(step)
        leave = min(leave, middle + wide)
        if middle - wide > enter:
            enter, surface = middle - wide, i + 3 if d[i] > 0.0 else i
    if surface < 0 or enter > leave:
        return MISS
    return enter, surface
