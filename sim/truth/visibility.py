"""People as upright bodies before cameras: their boxes, and how much of them rays would meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.products import fma
from peopleboy.sim.geometry.vectors import Point
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.physics import Physics
from peopleboy.sim.rendering.canvas import Lens
from peopleboy.sim.robot.robot_body import NAME
from peopleboy.sim.truth.scenes import BYSTANDER, Records

# Heights at which a person's middle is looked for, in shares of the stature.
_LOOKED_AT = (0.1, 0.3, 0.5, 0.7, 0.9)
_NEAREST_M = 0.05


class Uprights(NamedTuple):
    """Q people before cameras, one each.

    Attributes:
        boxes: (Q, 4) [px] left, top, width, height; NaN where somebody is not before the camera.
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
    """Tell which share of the points are inside the image with nothing solid before them.

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


# Where everybody is, and how much of them a camera could see: told by rays, not from an image.

_RAYS = 5


def bystanders(
    people: Sequence[Person], physics: Physics, robot: Matrix, world_from_robot: Matrix, camera: Pinhole
) -> Records:
    """Tell where everybody is who is present, and how much of them the robot's camera could see.

    Args:
        people: in the scenario's order.
        physics: the world, through which rays are cast.
        robot: (3,) [m, m, rad] pose on the floor.
        world_from_robot: (4, 4) the same pose.
        camera: the thermal camera.

    Returns:
        (Q,) records BYSTANDER.
    """
    present = [(number, person) for number, person in enumerate(people, 1) if person.present]
    found = np.zeros(len(present), BYSTANDER)
    if not present:
        return found
    found["id"] = [number for number, _ in present]
    for name, values in (
        ("position_m", [person.position for _, person in present]),
        ("velocity_m_s", [person.velocity for _, person in present]),
        ("heading_rad", [person.heading for _, person in present]),
        ("height_m", [person.config.height_m for _, person in present]),
        ("radius_m", [person.radius_m for _, person in present]),
    ):
        found[name] = values
    poses = (world_from_robot @ camera.robot_from_camera)[None].repeat(len(present), axis=0)
    uprights = stand_before(found["position_m"], found["height_m"], found["radius_m"], camera, poses)
    fraction = np.ones((len(present), _RAYS))
    looked = uprights.reaches_in
    eyes, points = uprights.eyes[looked].repeat(_RAYS, axis=0), uprights.points[looked].reshape(-1, 3)
    fraction[looked] = physics.cast_rays(eyes, points, ignore=NAME)[0].reshape(-1, _RAYS)
    look_at(found, robot[None], uprights, fraction)
    return found


def look_at(people: Records, robots: Matrix, uprights: Uprights, fraction: Matrix) -> None:
    """Note how robots see people.

    Args:
        people: (Q,) records BYSTANDER, of which the last four fields are filled.
        robots: (Q, 3) or (1, 3) [m, m, rad] where they look from.
        uprights: the people before their cameras.
        fraction: (Q, 5) as in `free_ray_shares`.
    """
    gaps = people["position_m"] - robots[:, :2]
    across, up = gaps[:, 0].tolist(), gaps[:, 1].tolist()
    people["distance_m"] = list(map(math.hypot, across, up))
    bearings = np.array(list(map(math.atan2, up, across))) - robots[:, 2]
    people["bearing_rad"] = [math.remainder(bearing, math.tau) for bearing in bearings.tolist()]
    people["box"] = uprights.boxes
    people["free_ray_share"] = free_ray_shares(uprights, fraction, people["radius_m"])
