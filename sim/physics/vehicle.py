"""A vehicle with two driven wheels: its outline from a URDF, and its step in kinematic physics."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.vectors import remainder
from peopleboy.sim.physics.footprints import (
    APART,
    MOST_POINTS,
    footprint,
    overlap,
    triangle_footprint,
)
from peopleboy.sim.physics.solid_shapes import Array, Placements, Solids
from peopleboy.sim.physics.urdf import UrdfLink
from peopleboy.sim.shapes.shapes import UPRIGHT, ShapeKind


class Vehicle(NamedTuple):
    """A vehicle in the format of the kernels; the origin of its root link is midway between the wheels.

    Attributes:
        middles, halves: (K, 2) [m] centres and half sizes of the upright boxes for collisions.
        heights: (K, 2) [m] lower and upper end of each box.
        reach_m: [m] radius of the circle about the origin that contains all boxes.
        centre: (2,) [m] centre of mass.
        gyration_m2: [m2] moment of inertia about the vertical axis through it, divided by the mass.
        wheel_radius_m, wheel_distance_m: [m].
    """

    middles: Array
    halves: Array
    heights: Array
    reach_m: float
    centre: Array
    gyration_m2: float
    wheel_radius_m: float
    wheel_distance_m: float


def wheels_of(name: str, links: Sequence[UrdfLink]) -> tuple[int, int]:
    """Return the link numbers of the left and the right wheel.

    Raises:
        BadInput: there are not exactly two wheels, solid cylinders to the left and right of the root.
    """
    turning = [number for number, link in enumerate(links) if link.turns]
    turning.sort(key=lambda number: -float(links[number].base_from_link[1, 3]))
    if len(turning) == 2 and all(_is_round(links[number]) for number in turning):
        left, right = turning
        if links[left].base_from_link[1, 3] > 0.0 > links[right].base_from_link[1, 3]:
            return left, right
    raise BadInput(
        f"body {name!r}: kinematic physics requires two wheels, cylinders on continuous joints to the left "
        "and to the right of the root link; fix the body in place, or choose physics bullet"
    )


def make_vehicle(name: str, links: Sequence[UrdfLink]) -> Vehicle:
    """Make a vehicle from its links.

    Raises:
        BadInput: it does not have two wheels, or its root link has no upright boxes.
    """
    left, right = (links[number] for number in wheels_of(name, links))
    boxes = links[0].solid
    if not boxes or any(box.kind != ShapeKind.BOX or box.orientation != UPRIGHT for box in boxes):
        raise BadInput(f"body {name!r}: kinematic physics requires upright collision boxes in the root link")
    middles = np.array([box.position[:2] for box in boxes])
    halves = np.array([box.size[:2] for box in boxes]) / 2.0
    rise = np.array([(box.position[2], box.size[2] / 2.0) for box in boxes])
    masses = np.array([link.mass_kg for link in links])
    centres = np.array([link.base_from_link[:3, :3] @ link.centre_m for link in links])[:, :2]
    centres += [link.base_from_link[:2, 3] for link in links]
    centre = masses @ centres / masses.sum()
    own = sum(link.inertia_kg_m2 for link in links)
    return Vehicle(
        middles=middles,
        halves=halves,
        heights=np.stack([rise[:, 0] - rise[:, 1], rise[:, 0] + rise[:, 1]], axis=1),
        reach_m=float(np.linalg.norm(np.abs(middles) + halves, axis=1).max()),
        centre=centre,
        gyration_m2=float((own + masses @ np.square(centres - centre).sum(axis=1)) / masses.sum()),
        wheel_radius_m=left.solid[0].size[1],
        wheel_distance_m=float(left.base_from_link[1, 3] - right.base_from_link[1, 3]),
    )


def _is_round(link: UrdfLink) -> bool:
    return len(link.solid) == 1 and link.solid[0].kind == ShapeKind.CYLINDER


class VehicleMotion(NamedTuple):
    """Pose and motion of the vehicle.

    Attributes:
        pose: (3,) x, y [m], heading [rad].
        angles, speeds: (2,) [rad], [rad/s] of the left and the right wheel.
        velocity: (3,) [m/s], [m/s], [rad/s] in the last step, world frame.
    """

    pose: Array
    angles: Array
    speeds: Array
    velocity: Array


class VehicleState(NamedTuple):
    """A kinematic world with its vehicle, whose body has the number `own`."""

    bodies: Placements
    solids: Solids
    motion: VehicleMotion
    vehicle: Vehicle
    own: int


TOUCH_M = 5e-4  # objects within this distance are touched
_PUSHES = 16
_ENOUGH_M = 1e-6
_MESH = int(ShapeKind.MESH)
_PLANE = int(ShapeKind.PLANE)

Contact = tuple[float, float, float, float, float]  # depth, normal x and y, position x and y; world frame


@njit(cache=True, nogil=True)
def advance(
    vehicle: Vehicle,
    motion: VehicleMotion,
    bodies: Placements,
    solids: Solids,
    own: int,
    dt_s: float,
    touched: NDArray[np.bool_],
) -> bool:
    """Roll a vehicle for one physics step, and push it out of solids.

    Its own solids are not updated until the next refresh, since it does not collide with itself.

    Args:
        vehicle: the vehicle.
        motion: its motion, changed in place.
        bodies: bodies with current poses; the vehicle's place is changed.
        solids: solids with current poses.
        own: number of the vehicle's body.
        dt_s: [s] duration of the step.
        touched: (B,) set to True for touched bodies.

    Returns:
        Whether the vehicle moved.
    """
    pose, speeds, velocity = motion.pose, motion.speeds, motion.velocity
    x, y, heading = pose[0], pose[1], pose[2]
    roll(vehicle, pose, speeds[0], speeds[1], dt_s)
    push_out(vehicle, pose, bodies, solids, own, touched)
    for k in range(2):
        motion.angles[k] += speeds[k] * dt_s
    dx, dy, turn = pose[0] - x, pose[1] - y, pose[2] - heading
    velocity[0], velocity[1], velocity[2] = dx / dt_s, dy / dt_s, remainder(turn) / dt_s
    has_moved = dx != 0.0 or dy != 0.0 or turn != 0.0
    if has_moved:
        place_on_floor(pose, bodies.places[own])
    return bool(has_moved)


@njit(cache=True, nogil=True)
def place_on_floor(pose: Array, place: Array) -> None:
    """Write the place (7,) of a body, position and quaternion, for a pose (3,) on the floor."""
    place[:] = 0.0
    place[0], place[1] = pose[0], pose[1]
    place[5], place[6] = math.sin(pose[2] / 2.0), math.cos(pose[2] / 2.0)


@njit(cache=True, nogil=True)
def roll(vehicle: Vehicle, pose: Array, left_rad_s: float, right_rad_s: float, dt_s: float) -> None:
    """Move a pose (3,), x, y [m] and heading [rad], along the arc of wheels without slip."""
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
    """Push a vehicle out of all solids, deepest contact first, until it is free or after 16 pushes.

    Each push translates and rotates it about its centre of mass like a free body, without friction.

    Args:
        vehicle: the vehicle.
        pose: (3,) its pose, changed in place.
        bodies: bodies with current poses.
        solids: solids with current poses.
        own: number of the vehicle's body.
        touched: (B,) set to True for touched bodies.
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
    """Return the angle, wrapped to half a turn around 0."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@njit(cache=True)
def _near(vehicle: Vehicle, pose: Array, bodies: Placements, solids: Solids, own: int) -> NDArray[np.int64]:
    """Return the numbers of the solids whose bounding boxes are near the vehicle."""
    near = np.empty(len(solids.boxes), np.int64)
    count = 0
    reach = vehicle.reach_m + 0.1  # margin for the pushes
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
    """Record touched bodies, and return the deepest contact."""
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
    """Return the number of convex pieces of a solid: the triangles of a mesh, else one."""
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
    """Return the contact of one box of the vehicle with one outline."""
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
