"""How panoramic cameras see: exactly, by the ray caster; what they see may go on over the seam."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Matrix, invert_pose
from peopleboy.sim.rendering.cover import Cover, count_cover
from peopleboy.sim.rendering.ring import Outline, draw_ring, make_drawing, outline, ring_of
from peopleboy.sim.rendering.sight import Edges, Mask, Scene, Sight
from peopleboy.sim.rendering.view import View, person_bits


class PanoramicSight(Sight):
    """How a panoramic camera sees, whatever the scene's renderer: there is one for it alone.

    The depth is the horizontal distance [m] from the camera's upright axis. What spans the seam, where the
    image's right border meets its left one, ends beyond the right border: its right edge lies at most one
    width right of where it would lie in the image. Edges are those of whole pixels; above and below, outlines
    go on beyond the image as `outline` says.
    """

    def view(self, scene: Scene, camera: Panorama, world_from_camera: Matrix) -> View:
        """Draw what a camera sees of a scene."""
        drawing, table = make_drawing(camera), scene.table
        shape = (camera.width, camera.height)
        part, depth = np.empty(shape, np.int32), np.empty(shape, np.float32)
        normal, shading = np.empty((*shape, 3), np.float32), np.empty((len(table.surface_part), 7))
        draw_ring(
            table, invert_pose(world_from_camera) @ scene.world_from_part, scene.hidden,
            person_bits(scene.person_of_part), ring_of(camera), shading, drawing,
            np.ascontiguousarray(world_from_camera[:3, :3]), part, depth, normal,
        )  # fmt: skip
        depth *= _horizontal(camera)
        depth += np.float32(camera.mirror.ring_radius_m)
        turned = (part.T, depth.T, normal.transpose(1, 0, 2), drawing.cover.T)
        return View(*map(np.ascontiguousarray, turned))

    def bounds(self, scene: Scene, camera: Panorama, world_from_camera: Matrix, parts: Mask) -> Edges:
        """Find the rectangle around all pixels that some parts (P,) would fill if nothing hid them."""
        filled = _alone(scene, camera, world_from_camera, parts)
        if not filled.pixels:
            return math.nan, math.nan, math.nan, math.nan
        first, last = first_and_last(filled.columns)
        return first - 0.5, filled.top - 0.5, last + 0.5, filled.bottom + 0.5

    def area(self, scene: Scene, camera: Panorama, world_from_camera: Matrix, parts: Mask) -> int:
        """Count the pixels that some parts (P,) would fill if nothing hid them."""
        return _alone(scene, camera, world_from_camera, parts).pixels

    def cover(self, view: View, owner_of_part: NDArray[np.int64], people: int, owners: int) -> Cover:
        """Count who covers whom; the last column of who is seen on both sides of the seam is beyond it."""
        cover = count_cover(view.part, view.cover, owner_of_part, people, owners)
        width = view.part.shape[1]
        for person in np.flatnonzero((cover.bounds[:, 0] == 0) & (cover.bounds[:, 1] == width - 1)):
            is_own = (view.part >= 0) & (owner_of_part[view.part] == person)
            cover.bounds[person, :2] = first_and_last(is_own.any(axis=0))
        return cover


def first_and_last(columns: Mask) -> tuple[int, int]:
    """First and last of the columns (W,) that are set, counted on over the seam: the widest gap lies outside.

    Raises:
        IndexError: none is set.
    """
    found = np.flatnonzero(columns)
    gaps = np.diff(found, append=found[0] + len(columns))
    widest = int(gaps.argmax())
    if gaps[widest] == gaps[-1]:
        return int(found[0]), int(found[-1])
    return int(found[widest + 1]), int(found[widest]) + len(columns)


def _alone(scene: Scene, camera: Panorama, world_from_camera: Matrix, parts: Mask) -> Outline:
    return outline(scene.table, invert_pose(world_from_camera) @ scene.world_from_part, parts, camera)


def _horizontal(camera: Panorama) -> NDArray[np.float32]:
    """(H,) [m] how far out a ray gets while it gets 1 m along the axis of its column's camera."""
    above = camera.mirror.axis_rad - camera.depression(np.arange(camera.height))
    return np.asarray(
        np.cos(camera.mirror.axis_rad) + np.sin(camera.mirror.axis_rad) * np.tan(above), np.float32
    )
