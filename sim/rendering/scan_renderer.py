"""Rendering of laser scans by the ray caster: each beam is a camera of one pixel."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, invert_pose
from peopleboy.sim.geometry.scan_plane import ScanPlane
from peopleboy.sim.rendering.panoramic_renderer import first_and_last
from peopleboy.sim.rendering.renderer import Mask, Renderer, Scene
from peopleboy.sim.rendering.ring import beams_of, draw_ring, make_drawing
from peopleboy.sim.rendering.view import View, person_bits

_BITS: Final = 64  # of a view's cover


class ScanRenderer(Renderer):
    """Renderer of laser range finders, whatever the scene's renderer.

    The depth is the range [m] along the beam. Outlines include beams outside the field of view: what lies
    left of it has negative columns.
    """

    def view(self, scene: Scene, camera: ScanPlane, world_from_camera: Matrix) -> View:
        """Cast the beams of a scan into a scene."""
        first = (camera.beams_per_turn - camera.width) // 2
        bits = person_bits(scene.person_of_part)
        return _cast(scene, camera, world_from_camera, bits, scene.hidden, (first, camera.width))

    def bounds(self, scene: Scene, camera: ScanPlane, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """Return rectangles (N, 4) around all beams that meet some parts (N, P), ignoring occlusion."""
        bounds = np.full((len(parts), 4), math.nan)
        first = (camera.beams_per_turn - camera.width) // 2
        for start in range(0, len(parts), _BITS):
            hits = _hits(scene, camera, world_from_camera, parts[start : start + _BITS])
            for one, columns in zip(bounds[start:], hits, strict=False):
                if columns.any():
                    left, right = first_and_last(columns)
                    one[:] = left - first - 0.5, -0.5, right - first + 0.5, 0.5
        return bounds

    def area(
        self,
        scene: Scene,
        camera: ScanPlane,
        world_from_camera: Matrix,
        parts: Mask,
        bounds: Sequence[float],
    ) -> int:
        """Count the beams of a whole turn that meet some parts (P,), ignoring occlusion."""
        if math.isnan(bounds[0]):
            return 0
        return int(np.count_nonzero(_hits(scene, camera, world_from_camera, parts[None])))


def _hits(scene: Scene, camera: ScanPlane, world_from_camera: Matrix, parts: Mask) -> Mask:
    """Return which beams of a whole turn (N, W) meet sets of parts (N, P), of which there are at most 64."""
    number = np.arange(len(parts), dtype=np.uint64)[:, None]
    bits = np.bitwise_or.reduce(np.where(parts, np.uint64(1) << number, np.uint64(0)), axis=0)
    turn = 0, camera.beams_per_turn
    seen = _cast(scene, camera, world_from_camera, bits, scene.hidden | (bits == 0), turn)
    return np.asarray((seen.cover >> number) & np.uint64(1), np.bool_)


def _cast(
    scene: Scene,
    camera: ScanPlane,
    world_from_camera: Matrix,
    bits: NDArray[np.uint64],
    skip: Mask,
    columns: tuple[int, int],
) -> View:
    """Cast beams, by first number and count; bits (P,) of each part are set in the cover."""
    (first, width), table = columns, scene.table
    drawing = make_drawing(width, 1)
    part, depth = np.empty((1, width), np.int32), np.empty((1, width), np.float32)
    normal, shading = np.empty((1, width, 3), np.float32), np.empty((len(table.surface_part), 7))
    draw_ring(
        table, invert_pose(world_from_camera) @ scene.world_from_part, skip, bits, beams_of(camera), first,
        shading, drawing, np.ascontiguousarray(world_from_camera[:3, :3]), part, depth, normal,
    )  # fmt: skip
    return View(part, depth, normal, np.ascontiguousarray(drawing.cover.T))
