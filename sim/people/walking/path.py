"""Paths over the floor: straight lines joined by arcs, and whether walls block a line."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, float]

# How far an arc may cut a corner [m], and the turn from which a person stops and turns on the spot.
CORNER_CUT_M = 0.05
_ABOUT_TURN_RAD = math.radians(115.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPiece:
    """A straight line or an arc.

    Attributes:
        start: (x, y) [m].
        heading_rad: [rad] direction at the start.
        length_m: [m].
        curvature: [1/m] positive turns left, 0 is straight.
        goal: index of the waypoint at its end.
    """

    start: Point
    heading_rad: float
    length_m: float
    curvature: float
    goal: int


def turn_between(before: float, after: float) -> float:
    """Return the signed angle [rad] from one direction to another, in -pi..pi."""
    return math.remainder(after - before, 2.0 * math.pi)


def route(points: Sequence[Point], first_goal: int) -> tuple[PathPiece, ...]:
    """Join points by lines with rounded corners.

    An arc leaves the corner by at most `CORNER_CUT_M` and takes up to half of the shorter line.

    Args:
        points: two or more points; neighbours differ.
        first_goal: index of the waypoint at the second point.
    """
    legs = [np.subtract(b, a) for a, b in pairwise(points)]
    lengths = [float(np.hypot(*leg)) for leg in legs]
    headings = [math.atan2(leg[1], leg[0]) for leg in legs]
    pieces = []
    used = 0.0
    for i, (length, heading) in enumerate(zip(lengths, headings, strict=True)):
        turn = turn_between(heading, headings[i + 1]) if i + 1 < len(legs) else 0.0
        trim, radius = _corner(turn, min(lengths[i : i + 2]) / 2.0)
        direction = np.array([math.cos(heading), math.sin(heading)])
        begin, end = np.array(points[i]) + used * direction, np.array(points[i + 1]) - trim * direction
        goal = first_goal + i
        pieces.append(_piece(begin, heading, length - used - trim, 0.0, goal))
        if trim > 0.0:
            pieces.append(_piece(end, heading, radius * abs(turn), math.copysign(1.0 / radius, turn), goal))
        used = trim
    return tuple(pieces)


def _piece(start: Array, heading: float, length: float, curvature: float, goal: int) -> PathPiece:
    at = (float(start[0]), float(start[1]))
    return PathPiece(start=at, heading_rad=heading, length_m=max(length, 0.0), curvature=curvature, goal=goal)


def _corner(turn: float, longest_trim: float) -> tuple[float, float]:
    """Return the length that an arc takes off both lines at a corner, and its radius [m]."""
    if abs(turn) < 1e-6:
        return 0.0, math.inf
    tangent = math.tan(abs(turn) / 2.0)
    radius = min(CORNER_CUT_M / (1.0 / math.cos(abs(turn) / 2.0) - 1.0), longest_trim / tangent)
    return radius * tangent, radius


def is_about_turn(before: Point, corner: Point, after: Point) -> bool:
    """Return whether a corner is so sharp that people stop and turn on the spot."""
    first, second = np.subtract(corner, before), np.subtract(after, corner)
    turn = turn_between(math.atan2(first[1], first[0]), math.atan2(second[1], second[0]))
    return abs(turn) > _ABOUT_TURN_RAD


def abreast(path: Sequence[Point], offset_m: float) -> tuple[Point, ...]:
    """Shift a path sideways, for a person who walks beside another one.

    Every line of the result is parallel to its original at the given distance; corners are where the shifted
    lines meet.

    Args:
        path: two or more points; neighbours differ.
        offset_m: [m] positive to the left of the walking direction.
    """
    points = np.array(path, dtype=float)
    legs = np.diff(points, axis=0)
    along = legs / np.linalg.norm(legs, axis=1, keepdims=True)
    left = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    shifted = [points[0] + offset_m * left[0]]
    for i in range(1, len(points) - 1):
        cosine = float(left[i - 1] @ left[i])
        if cosine < -0.99:
            shifted.append(points[i] + offset_m * left[i - 1])
            continue
        shifted.append(points[i] + offset_m * (left[i - 1] + left[i]) / (1.0 + cosine))
    shifted.append(points[-1] + offset_m * left[-1])
    return tuple((float(x), float(y)) for x, y in shifted)


def is_free(start: Array, end: Array, walls: Array, margin_m: float = 0.0) -> bool:
    """Return whether a straight line keeps clear of all rectangles.

    A rectangle that contains the start is ignored, such as the chair that a person sits on. If a rectangle is
    nearer to the start than the margin, its distance at the start is the margin.

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
