"""Find the shortest route on the floor around rectangles: A* on the visibility graph of their corners."""

import heapq
import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.places.floor_plan import FloorPlan, Rectangle

Point = tuple[float, float]
_OFF_M = 0.01  # routes pass corners at this distance, so that they do not touch the rectangles


def find_route(
    plan: FloorPlan, boxes: Sequence[Rectangle], start: Point, end: Point
) -> tuple[Point, ...] | None:
    """Return the corners of the shortest route between two free points, both included; None without a route.

    Args:
        plan: floor plan that the corners must be on.
        boxes: rectangles that the route avoids, already grown by the radius of what moves along it.
        start: x, y [m].
        end: x, y [m].
    """
    taken = np.array([(b.min_x, b.min_y, b.max_x, b.max_y) for b in boxes]).reshape(-1, 4)
    nodes = np.array([start, end, *_corners(plan, boxes, taken)])
    to_go = np.hypot(*(nodes - nodes[1]).T)
    length_m, before = np.full(len(nodes), math.inf), np.zeros(len(nodes), np.int64)
    length_m[0], is_done = 0.0, np.zeros(len(nodes), np.bool_)
    queue = [(float(to_go[0]), 0)]
    while queue:
        _, node = heapq.heappop(queue)
        if node == 1:
            return _trace(nodes, before)
        if is_done[node]:
            continue
        is_done[node] = True
        others = np.flatnonzero(~is_done)
        others = others[~_crosses_any(nodes[node], nodes[others], taken)]
        reached = length_m[node] + np.hypot(*(nodes[others] - nodes[node]).T)
        is_shorter = reached < length_m[others]
        for other, so_far in zip(others[is_shorter].tolist(), reached[is_shorter].tolist(), strict=True):
            length_m[other], before[other] = so_far, node
            heapq.heappush(queue, (so_far + float(to_go[other]), other))
    return None


def route_m(route: Sequence[Point]) -> float:
    """Return the length of a route [m]."""
    return sum(math.dist(one, other) for one, other in pairwise(route))


def _corners(plan: FloorPlan, boxes: Sequence[Rectangle], taken: NDArray[np.float64]) -> list[Point]:
    """Return the corners of the rectangles that are on free floor."""
    grown = (box.grown(_OFF_M) for box in boxes)
    corners = {(x, y) for box in grown for x in (box.min_x, box.max_x) for y in (box.min_y, box.max_y)}
    return [
        (x, y)
        for x, y in sorted(corners)
        if plan.contains(x, y)
        and not np.any((taken[:, 0] <= x) & (x <= taken[:, 2]) & (taken[:, 1] <= y) & (y <= taken[:, 3]))
    ]


def _crosses_any(
    start: NDArray[np.float64], ends: NDArray[np.float64], boxes: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return which lines from one point to the points (N, 2) cross any rectangle (K, 4); see `crosses`."""
    first, last = np.zeros((len(ends), len(boxes))), np.ones((len(ends), len(boxes)))
    for axis in (0, 1):
        way = (ends[:, axis] - start[axis])[:, None]
        low, high = boxes[:, axis] - start[axis], boxes[:, axis + 2] - start[axis]
        with np.errstate(divide="ignore", invalid="ignore"):
            near, far = np.sort([low / way, high / way], axis=0)
        is_along = np.abs(way) < 1e-12
        is_between = (low < 0.0) & (high > 0.0)
        near = np.where(is_along, np.where(is_between, -math.inf, math.inf), near)
        far = np.where(is_along, math.inf, far)
        first, last = np.maximum(first, near), np.minimum(last, far)
    return np.asarray((first < last).any(axis=1))


def _trace(nodes: NDArray[np.float64], before: NDArray[np.int64]) -> tuple[Point, ...]:
    route = [1]
    while route[-1] != 0:
        route.append(int(before[route[-1]]))
    return tuple((float(x), float(y)) for x, y in nodes[route[::-1]])
