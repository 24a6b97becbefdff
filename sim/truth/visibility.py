"""How much of people robots could see, from rays to upright bodies that stand for them (numba kernels)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.vectors import Point, fma
from peopleboy.sim.people.person import Person
from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.truth.scenes import BYSTANDER, Records

CastRays: TypeAlias = Callable[[NDArray[np.int64], Matrix, Matrix], Matrix]
"""Takes numbers (K,) of people, starts and ends (K, 5, 3) [m] of rays, gives the shares (K, 5) of their ways
at which they hit something other than the robot that sends them out."""

# Heights at which a person's middle is looked for, in shares of the stature.
_LOOKED_AT = (0.1, 0.3, 0.5, 0.7, 0.9)
_NEAREST_M = 0.05


class Uprights(NamedTuple):
    """Q people before cameras, one each.

    Attributes:
        boxes: (Q, 4) [px] left, top, width, height; NaN where a person is not before the camera.
        reaches_in: (Q,) whether any of the box lies in the image.
        eyes: (Q, 3) [m] where each one's camera is, world frame.
        points: (Q, 5, 3) [m] up each one's middle, world frame.
        is_inside: (Q, 5) whether each lies in the image.
    """

    boxes: Matrix
    reaches_in: NDArray[np.bool_]
    eyes: Matrix
    points: Matrix
    is_inside: NDArray[np.bool_]


def stand_before(
    places: Matrix, heights_m: Matrix, radii_m: Matrix, camera: Pinhole, world_from_camera: Matrix
) -> Uprights:
    """See upright bodies with a camera at a pose each.

    Args:
        places: (Q, 2) [m] on the floor, world frame.
        heights_m: (Q,).
        radii_m: (Q,).
        camera: of all of them.
        world_from_camera: (Q, 4, 4).
    """
    count = len(places)
    found = Uprights(
        boxes=np.empty((count, 4)),
        reaches_in=np.empty(count, np.bool_),
        eyes=world_from_camera[:, :3, 3],
        points=np.empty((count, len(_LOOKED_AT), 3)),
        is_inside=np.empty((count, len(_LOOKED_AT)), np.bool_),
    )
    u, v = camera.centre_px
    lens = Lens(camera.focal_px, u, v, camera.width, camera.height)
    _stand_before(places, heights_m, radii_m, lens, world_from_camera, found)
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def _stand_before(
    places: Matrix, heights_m: Matrix, radii_m: Matrix, lens: Lens, poses: Matrix, found: Uprights
) -> None:
    camera_from_world = np.empty((3, 4))
    for q in range(len(places)):
        _invert(poses[q], camera_from_world)
        x, y, height = places[q, 0], places[q, 1], heights_m[q]
        head, foot = _seen(camera_from_world, x, y, height), _seen(camera_from_world, x, y, 0.0)
        middle = _seen(camera_from_world, x, y, height / 2.0)
        box, half = found.boxes[q], lens.focal * radii_m[q] / middle[2]
        top, bottom = _shown(head, lens)[1], _shown(foot, lens)[1]
        box[0], box[1], box[2], box[3] = _shown(middle, lens)[0] - half, top, 2.0 * half, bottom - top
        if min(head[2], foot[2], middle[2]) < _NEAREST_M:
            box[:] = np.nan
        found.reaches_in[q] = (  # which a box of NaN does not
            (box[0] + box[2] > -0.5)
            & (box[0] < lens.width)
            & (box[1] + box[3] > -0.5)
            & (box[1] < lens.height)
        )
        for k in range(len(_LOOKED_AT)):
            point = found.points[q, k]
            point[0], point[1], point[2] = x, y, _LOOKED_AT[k] * height
            u, v = _shown(_seen(camera_from_world, point[0], point[1], point[2]), lens)
            is_across, is_up = (u > -0.5) & (u < lens.width - 0.5), (v > -0.5) & (v < lens.height - 0.5)
            found.is_inside[q, k] = is_across & is_up


@njit(cache=True)
def _invert(pose: Matrix, inverse: Matrix) -> None:
    """Write the inverse (3, 4) of a rigid pose, its sums rounded as BLAS does in products with one vector."""
    for i in range(3):
        for k in range(3):
            inverse[i, k] = pose[k, i]
        first = fma(-pose[0, i], pose[0, 3], -pose[1, i] * pose[1, 3])
        inverse[i, 3] = fma(-pose[2, i], pose[2, 3], first)


@njit(cache=True)
def _seen(camera_from_world: Matrix, x: float, y: float, z: float) -> Point:
    """A point of the world in the optical frame, its sums rounded as in `products`."""
    rows = camera_from_world
    return (
        fma(z, rows[0, 2], fma(y, rows[0, 1], x * rows[0, 0])) + rows[0, 3],
        fma(z, rows[1, 2], fma(y, rows[1, 1], x * rows[1, 0])) + rows[1, 3],
        fma(z, rows[2, 2], fma(y, rows[2, 1], x * rows[2, 0])) + rows[2, 3],
    )


@njit(cache=True, error_model="numpy")
def _shown(point: Point, lens: Lens) -> tuple[float, float]:
    """Do as `Pinhole.project` with one point."""
    z = point[2] if point[2] > 1e-9 else np.nan
    return lens.focal * point[0] / z + lens.centre_u, lens.focal * point[1] / z + lens.centre_v


def free_ray_shares(uprights: Uprights, fraction: Matrix, radii_m: Matrix) -> Matrix:
    """Return which share of the points are inside the image with nothing solid before them.

    Args:
        uprights: Q people.
        fraction: (Q, 5) of the way from their eyes to their points at which rays hit something.
        radii_m: (Q,) [m] of the people; a ray ends within the capsule of the person whom it looks for, which
            it meets a radius before.

    Returns:
        (Q,) 0 for those who do not reach into the image.
    """
    shares = np.zeros(len(fraction))
    _count_free(uprights, fraction, radii_m, shares)
    return shares


@njit(cache=True, nogil=True)
def _count_free(uprights: Uprights, fraction: Matrix, radii_m: Matrix, shares: Matrix) -> None:
    rays = fraction.shape[1]
    for q in range(len(fraction)):
        if not uprights.reaches_in[q]:
            continue
        free = 0
        for k in range(rays):
            point, eye = uprights.points[q, k], uprights.eyes[q]
            x, y, z = point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]
            short = math.sqrt(x * x + y * y + z * z) * (1.0 - fraction[q, k])
            free += uprights.is_inside[q, k] and short <= 1.5 * radii_m[q]
        shares[q] = free / rays


def known_people(people: Sequence[Person]) -> Records:
    """(Q,) records BYSTANDER with what never changes of the people of one world: id, height and radius."""
    known = np.zeros(len(people), BYSTANDER)
    known["id"] = range(1, len(people) + 1)
    known["height_m"] = [person.config.height_m for person in people]
    known["radius_m"] = [person.radius_m for person in people]
    return known


def look_at_people(
    people: Records, robots: Matrix, camera: Pinhole, world_from_camera: Matrix, cast: CastRays
) -> None:
    """Fill in where people are as robots see them, and how much of them their cameras could see.

    Args:
        people: (Q,) records BYSTANDER, all present, of which the last four fields are filled.
        robots: (Q, 3) or (1, 3) [m, m, rad] poses of the robots that look at them.
        camera: of all robots.
        world_from_camera: (Q, 4, 4).
        cast: casts the rays to some of the people.
    """
    if not len(people):
        return
    uprights = stand_before(
        people["position_m"], people["height_m"], people["radius_m"], camera, world_from_camera
    )
    fraction = np.ones(uprights.points.shape[:2])
    in_view = np.flatnonzero(uprights.reaches_in)
    if len(in_view):
        ends = uprights.points[in_view]
        starts = uprights.eyes[in_view].repeat(ends.shape[1], axis=0).reshape(ends.shape)
        fraction[in_view] = cast(in_view, starts, ends)
    gaps = people["position_m"] - robots[:, :2]
    across, up = gaps[:, 0].tolist(), gaps[:, 1].tolist()
    people["distance_m"] = list(map(math.hypot, across, up))
    bearings = np.array(list(map(math.atan2, up, across))) - robots[:, 2]
    people["bearing_rad"] = [math.remainder(bearing, math.tau) for bearing in bearings.tolist()]
    people["box"] = uprights.boxes
    people["free_ray_share"] = free_ray_shares(uprights, fraction, people["radius_m"])
