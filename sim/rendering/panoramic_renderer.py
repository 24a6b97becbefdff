"""Rendering of panoramic cameras by the ray caster; objects may extend across the seam."""

import math
from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Matrix, invert_pose
from peopleboy.sim.rendering.renderer import Mask, Renderer, Scene
from peopleboy.sim.rendering.ring import Outline, draw_ring, make_drawing, outline, ring_of
from peopleboy.sim.rendering.view import NO_PERSON, Cover, View, count_cover, person_bits

_Key = tuple[Panorama, bytes, bytes]


class PanoramicRenderer(Renderer):
    """Renderer of panoramic cameras, whatever the scene's renderer.

    The depth is the horizontal distance [m] from the camera's upright axis. What spans the seam, where the
    image's right border meets its left one, ends beyond the right border: its right edge lies at most one
    width right of where it would lie in the image. Edges are those of whole pixels; above and below, outlines
    go on beyond the image as `outline` says.
    """

    def __init__(self) -> None:
        self._outlines: WeakKeyDictionary[Scene, dict[_Key, tuple[Outline, NDArray[np.uint64]]]]
        self._outlines = WeakKeyDictionary()

    def view(self, scene: Scene, camera: Panorama, world_from_camera: Matrix) -> View:
        """Render a camera's view of a scene."""
        drawing, table = make_drawing(camera.width, camera.height), scene.table
        shape = (camera.height, camera.width)
        part, depth = np.empty(shape, np.int32), np.empty(shape, np.float32)
        normal, shading = np.empty((*shape, 3), np.float32), np.empty((len(table.surface_part), 7))
        draw_ring(
            table, invert_pose(world_from_camera) @ scene.world_from_part, scene.hidden,
            person_bits(scene.person_of_part), ring_of(camera), 0, shading, drawing,
            np.ascontiguousarray(world_from_camera[:3, :3]), part, depth, normal,
        )  # fmt: skip
        depth *= _horizontal(camera)[:, None]
        depth += np.float32(camera.mirror.ring_radius_m)
        return View(part, depth, normal, np.ascontiguousarray(drawing.cover.T))

    def bounds(self, scene: Scene, camera: Panorama, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """Return rectangles (N, 4) around all pixels of some parts (N, P), ignoring occlusion."""
        bounds = np.full((len(parts), 4), math.nan)
        for one, own in zip(bounds, parts, strict=True):
            filled, wanted = self._outline(scene, camera, world_from_camera, own)
            rows, columns = np.flatnonzero(filled.rows & wanted), filled.columns & wanted
            if len(rows):
                first, last = first_and_last(columns != 0)
                top, bottom = int(rows[0]) + filled.first_row, int(rows[-1]) + filled.first_row
                one[:] = first - 0.5, top - 0.5, last + 0.5, bottom + 0.5
        return bounds

    def area(
        self,
        scene: Scene,
        camera: Panorama,
        world_from_camera: Matrix,
        parts: Mask,
        bounds: Sequence[float],
    ) -> int:
        """Count the pixels of some parts (P,) within their `bounds`, ignoring occlusion."""
        if math.isnan(bounds[0]):
            return 0
        filled, wanted = self._outline(scene, camera, world_from_camera, parts)
        return int(np.count_nonzero(filled.pixels & wanted))

    def cover(self, view: View, owner_of_part: NDArray[np.int64], people: int, owners: int) -> Cover:
        """Count occlusions between people; a person across the seam has a last column beyond it."""
        cover = count_cover(view.part, view.cover, owner_of_part, people, owners)
        width = view.part.shape[1]
        for person in np.flatnonzero((cover.bounds[:, 0] == 0) & (cover.bounds[:, 1] == width - 1)):
            is_own = (view.part >= 0) & (owner_of_part[view.part] == person)
            cover.bounds[person, :2] = first_and_last(is_own.any(axis=0))
        return cover

    def _outline(
        self, scene: Scene, camera: Panorama, world_from_camera: Matrix, parts: Mask
    ) -> tuple[Outline, np.uint64]:
        """Return the outlines of a scene, drawn once, and the bits of some parts (P,)."""
        person = scene.person_of_part[parts.argmax()]
        of_one = scene.person_of_part == person
        if person == NO_PERSON or (parts & ~of_one).any():
            of_one = parts
        key = camera, world_from_camera.tobytes(), of_one.tobytes()
        known = self._outlines.setdefault(scene, {})
        if key not in known:
            bits = np.where(of_one, np.uint64(1) << (np.cumsum(of_one) % 64).astype(np.uint64), np.uint64(0))
            ring_from_part = invert_pose(world_from_camera) @ scene.world_from_part
            known[key] = outline(scene.table, ring_from_part, bits, camera), bits
        filled, bits = known[key]
        return filled, np.bitwise_or.reduce(bits[parts], initial=np.uint64(0))


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


def _horizontal(camera: Panorama) -> NDArray[np.float32]:
    """(H,) [m] how far out a ray gets while it gets 1 m along the axis of its column's camera."""
    above = camera.mirror.axis_rad - camera.depression(np.arange(camera.height))
    return np.asarray(
        np.cos(camera.mirror.axis_rad) + np.sin(camera.mirror.axis_rad) * np.tan(above), np.float32
    )
