"""People as upright bodies before cameras: their boxes, and how much of them rays would meet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole

# Heights at which a person's middle is looked for, in shares of the stature.
_LOOKED_AT = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
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
    ends = np.concatenate([places, np.zeros((len(places), 1))], axis=1)[:, None, :].repeat(3, axis=1)
    ends[:, 0, 2], ends[:, 2, 2] = heights_m, heights_m / 2.0
    points = ends[:, :1].repeat(len(_LOOKED_AT), axis=1)
    points[:, :, 2] = _LOOKED_AT * heights_m[:, None]
    camera_from_world = _inverses(world_from_camera)
    seen = _transforms(camera_from_world, ends)
    shown = camera.project(seen)
    half = camera.focal_px * radii_m / seen[:, 2, 2]
    left, top = shown[:, 2, 0] - half, shown[:, 0, 1]
    boxes = np.stack([left, top, 2.0 * half, shown[:, 1, 1] - top], axis=1)
    boxes[seen[:, :, 2].min(axis=1) < _NEAREST_M] = np.nan
    u, v = np.moveaxis(camera.project(_transforms(camera_from_world, points)), -1, 0)
    is_inside = (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    return Uprights(boxes, _reach_in(boxes, camera), world_from_camera[:, :3, 3], points, is_inside)


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
    gaps = uprights.points - uprights.eyes[:, None, :]
    short = np.linalg.norm(gaps, axis=-1) * (1.0 - fraction)
    is_free = short <= 1.5 * radii_m[:, None]
    return np.where(uprights.reaches_in, np.mean(uprights.is_inside & is_free, axis=1), 0.0)


def _reach_in(boxes: Matrix, camera: Pinhole) -> NDArray[np.bool_]:
    """Tell which boxes (Q, 4) reach into the image; a box of NaN does not."""
    left, top, width, height = boxes.T
    found: NDArray[np.bool_] = (
        (left + width > -0.5) & (left < camera.width) & (top + height > -0.5) & (top < camera.height)
    )
    return found


def _inverses(poses: Matrix) -> Matrix:
    """Invert rigid (Q, 4, 4) poses."""
    inverses = np.zeros_like(poses)
    inverses[:, :3, :3] = poses[:, :3, :3].transpose(0, 2, 1)
    inverses[:, :3, 3] = (-inverses[:, :3, :3] @ poses[:, :3, 3, None])[..., 0]
    inverses[:, 3, 3] = 1.0
    return inverses


def _transforms(poses: Matrix, points: Matrix) -> Matrix:
    """Map (Q, N, 3) points by (Q, 4, 4) poses, one each."""
    mapped: Matrix = points @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
    return mapped
