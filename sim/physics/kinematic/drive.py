"""One step of a vehicle: it rolls as its wheels turn, and is pushed out of what it is in (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.physics.kinematic.footprints import MOST_POINTS, footprint, triangle_footprint
from peopleboy.sim.physics.kinematic.overlap import APART, overlap
from peopleboy.sim.physics.kinematic.vehicle import Vehicle
from peopleboy.sim.physics.solids.solids import Array, Placements, Solids
from peopleboy.sim.shapes.shapes import ShapeKind

TOUCH_M = 5e-4  # what is nearer is touched
_PUSHES = 16
_ENOUGH_M = 1e-6
_MESH = int(ShapeKind.MESH)
_PLANE = int(ShapeKind.PLANE)

Contact = tuple[float, float, float, float, float]  # depth, normal x and y, where x and y; world frame


@njit(cache=True, nogil=True)
def roll(vehicle: Vehicle, pose: Array, left_rad_s: float, right_rad_s: float, dt_s: float) -> None:
    """Move a pose (3,), x, y [m] and heading [rad], along the arc of wheels that do not slip."""
    left, right = left_rad_s * vehicle.wheel_radius_m, right_rad_s * vehicle.wheel_radius_m
    turn = (right - left) / vehicle.wheel_distance_m * dt_s
    advance = (left + right) / 2.0 * dt_s
    half = turn / 2.0
    chord = advance * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    pose[0] += chord * math.cos(pose[2] + half)
    pose[1] += chord * math.sin(pose[2] + half)
    pose[2] = _wrapped(pose[2] + turn)


@njit(cache=True, nogil=True)
def push_out(
    vehicle: Vehicle, pose: Array, bodies: Placements, solids: Solids, own: int, touched: NDArray[np.bool_]
) -> None:
    """Push a vehicle out of all solids, the deepest contact first, until it is in none or 16 pushes are done.

    Each push moves and turns it about its centre of mass as a free body that is hit there, without friction.

    Args:
        vehicle: what it is.
        pose: (3,) changed in place.
        bodies: up to date.
        solids: likewise.
        own: number of the vehicle's body.
        touched: (B,) gets True for the bodies that it touches.
    """
    near = _near(vehicle, pose, bodies, solids, own)
    if len(near) == 0:
        return
    for _ in range(_PUSHES):
        depth, nx, ny, x, y = _deepest(vehicle, pose, bodies, solids, near, touched)
        if depth <= _ENOUGH_M:
            return
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        cx = pose[0] + cos * vehicle.centre[0] - sin * vehicle.centre[1]
        cy = pose[1] + sin * vehicle.centre[0] + cos * vehicle.centre[1]
        arm = (x - cx) * ny - (y - cy) * nx
        push = depth / (1.0 + arm * arm / vehicle.gyration_m2)
        pose[2] = _wrapped(pose[2] + push * arm / vehicle.gyration_m2)
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        pose[0] = cx + push * nx - cos * vehicle.centre[0] + sin * vehicle.centre[1]
        pose[1] = cy + push * ny - sin * vehicle.centre[0] - cos * vehicle.centre[1]


@njit(cache=True)
def _wrapped(angle: float) -> float:
    """The same angle within half a turn of 0."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@njit(cache=True)
def _near(vehicle: Vehicle, pose: Array, bodies: Placements, solids: Solids, own: int) -> NDArray[np.int64]:
    """Numbers of the solids whose boxes come near the vehicle."""
    near = np.empty(len(solids.boxes), np.int64)
    count = 0
    reach = vehicle.reach_m + 0.1  # as it is pushed meanwhile
    low, high = vehicle.heights.min(), vehicle.heights.max()
    for k in range(len(solids.boxes)):
        body, box = bodies.of_part[solids.table.part[k]], solids.boxes[k]
        if body == own or bodies.hidden[body] or solids.table.kind[k] == _PLANE:
            continue
        if box[0, 2] >= high or box[1, 2] <= low:
            continue
        x = max(box[0, 0] - pose[0], pose[0] - box[1, 0], 0.0)
        y = max(box[0, 1] - pose[1], pose[1] - box[1, 1], 0.0)
        if x * x + y * y < reach * reach:
            near[count] = k
            count += 1
    return near[:count]


@njit(cache=True)
def _deepest(
    vehicle: Vehicle,
    pose: Array,
    bodies: Placements,
    solids: Solids,
    near: NDArray[np.int64],
    touched: NDArray[np.bool_],
) -> Contact:
    """Note what is touched, and tell the deepest contact."""
    outline = np.empty((MOST_POINTS + 1, 2))
    best: Contact = (-math.inf, 0.0, 0.0, 0.0, 0.0)
    for k in near:
        for piece in range(_pieces(solids, k)):
            for box in range(len(vehicle.halves)):
                low, high = vehicle.heights[box, 0], vehicle.heights[box, 1]
                count, radius = _outline(solids, k, piece, low, high, outline)
                if count > 0:
                    contact = _meet(vehicle, box, pose, outline[:count], radius)
                    if contact[0] > -TOUCH_M:
                        touched[bodies.of_part[solids.table.part[k]]] = True
                    if contact[0] > best[0]:
                        best = contact
    return best


@njit(cache=True)
def _pieces(solids: Solids, k: int) -> int:
    """Convex pieces of a solid: the triangles of a mesh, else one."""
    if solids.table.kind[k] == _MESH:
        return int(solids.table.triangle_range[k, 1] - solids.table.triangle_range[k, 0])
    return 1


@njit(cache=True)
def _outline(
    solids: Solids, k: int, piece: int, low_m: float, high_m: float, outline: Array
) -> tuple[int, float]:
    """Write the outline of a piece of a solid between two heights; see `footprint`."""
    table = solids.table
    if table.kind[k] == _MESH:
        corners = table.triangles[table.triangle_range[k, 0] + piece]
        return triangle_footprint(corners, solids.poses[k], low_m, high_m, outline), 0.0
    return footprint(table.kind[k], table.size[k], solids.poses[k], low_m, high_m, outline)


@njit(cache=True)
def _meet(vehicle: Vehicle, box: int, pose: Array, outline: Array, radius: float) -> Contact:
    """One box of the vehicle against one outline."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    local = np.empty_like(outline)
    for k in range(len(outline)):
        x, y = outline[k, 0] - pose[0], outline[k, 1] - pose[1]
        local[k, 0] = cos * x + sin * y - vehicle.middles[box, 0]
        local[k, 1] = cos * y - sin * x - vehicle.middles[box, 1]
    depth, nx, ny, along = overlap(vehicle.halves[box], local, radius + TOUCH_M)
    if depth == APART[0]:
        return depth, 0.0, 0.0, 0.0, 0.0
    back = abs(nx) * vehicle.halves[box, 0] + abs(ny) * vehicle.halves[box, 1]
    x = vehicle.middles[box, 0] - back * nx - along * ny
    y = vehicle.middles[box, 1] - back * ny + along * nx
    return (
        depth - TOUCH_M,
        cos * nx - sin * ny,
        sin * nx + cos * ny,
        pose[0] + cos * x - sin * y,
        pose[1] + sin * x + cos * y,
    )
