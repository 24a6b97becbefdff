"""How cameras see: what lies behind their pixels, and the outlines of what stands alone before them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.camera_geometry import CameraGeometry
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.rendering.view import NOBODY, Cover, View, count_cover
from peopleboy.sim.shapes.shape_table import ShapeTable

if TYPE_CHECKING:
    from peopleboy.sim.physics.physics_engine import Physics
from numba import njit

from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.rendering.render_canvas import Lens, make_canvas
from peopleboy.sim.shapes.bounds import EMPTY, shape_bounds, unite

# How large a person would be in the image if nothing hid it.

Array = NDArray[np.float64]


def silhouette_bounds(camera: Pinhole, table: ShapeTable, camera_from_part: Matrix, parts: Mask) -> Array:
    """Find the rectangles around all that the camera would see of sets of parts if nothing hid them.

    They may lie outside the image. What is nearer than 0.05 m along the optical axis does not count.

    Args:
        camera: the pinhole camera.
        table: the world's shapes.
        camera_from_part: (P, 4, 4) poses in the optical frame.
        parts: (N, P) which parts.

    Returns:
        (N, 4) left, top, right, bottom [px]; NaN where nothing lies before the camera.
    """
    found = np.empty((len(parts), 4))
    _bounds(table, camera_from_part, parts, found)
    (u, v), focal = camera.centre_px, camera.focal_px
    found[found[:, 0] > found[:, 2]] = math.nan
    bounds: Array = (u, v, u, v) + focal * found
    return bounds


def silhouette_area(
    camera: Pinhole, table: ShapeTable, camera_from_part: Matrix, parts: Mask, bounds: Sequence[float]
) -> int:
    """Count the pixels that some parts (P,) would fill if nothing hid them, the image's border neither.

    The image is continued by its own width and height beyond each border; arguments are as in
    `silhouette_bounds`, and what that says of the parts.
    """
    if math.isnan(bounds[0]):
        return 0
    left, right = _within(bounds[0], bounds[2], camera.width)
    top, bottom = _within(bounds[1], bounds[3], camera.height)
    if left > right or top > bottom:
        return 0
    u, v = camera.centre_px
    lens = Lens(camera.focal_px, u - left, v - top, right - left + 1, bottom - top + 1)
    canvas = make_canvas(lens, len(table.surface_part))
    bits = np.ones(len(parts), np.uint64)
    draw(table, camera_from_part, ~parts, bits, lens, canvas)
    return int(np.count_nonzero(canvas.cover))


def _within(low: float, high: float, size: int) -> tuple[int, int]:
    """First and last pixel of an interval within the image and one image on either side."""
    return math.ceil(max(low, -float(size))), math.floor(min(high, 2.0 * size - 1.0))


@njit(cache=True)
def _bounds(table: ShapeTable, camera_from_part: Array, parts: Mask, found: Array) -> None:
    """Write the bounds (N, 4) of several sets of parts (N, P) at a distance of 1."""
    pose = np.empty((3, 4))
    for n in range(len(parts)):
        found[n, 0], found[n, 1], found[n, 2], found[n, 3] = EMPTY
    for shape in range(len(table.kind)):
        part = table.part[shape]
        wanted = False
        for n in range(len(parts)):
            wanted |= parts[n, part]
        if not wanted:
            continue
        compose(camera_from_part[part], table.part_from_shape[shape], pose)
        first, end = table.triangle_range[shape]
        own = shape_bounds(table.kind[shape], table.size[shape], pose, table.triangles[first:end])
        for n in range(len(parts)):
            if parts[n, part]:
                before = (found[n, 0], found[n, 1], found[n, 2], found[n, 3])
                found[n, 0], found[n, 1], found[n, 2], found[n, 3] = unite(before, own)


Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, weakref_slot=True)
class Scene:
    """All that there is to be seen at an instant.

    Attributes:
        renderer: name of what draws it for pinhole cameras.
        physics: the world.
        table: its visible shapes.
        world_from_part: (P, 4, 4).
        person_of_part: (P,) number of the person that a part belongs to, -1 for none.
        hidden: (P,) parts that are not there.
    """

    renderer: str
    physics: Physics
    table: ShapeTable
    world_from_part: Matrix
    person_of_part: NDArray[np.int64]
    hidden: Mask

    def only(self, parts: Mask) -> Scene:
        """The same scene with some parts (P,) alone, as those of one person."""
        return replace(self, person_of_part=np.where(parts, 0, NOBODY), hidden=~parts)


class Renderer(ABC):
    """How the cameras of one geometry see; what `PinholeRenderer` does is for pinholes alone.

    A new one has to say `view`. Its outlines follow from that, in whole pixels and no farther than the image;
    one that can say more of them, or says it sooner, does.
    """

    @abstractmethod
    def view(self, scene: Scene, camera: Any, world_from_camera: Matrix) -> View:
        """Draw what a camera sees of a scene; its pose is (4, 4), optical frame to world."""

    def bounds(self, scene: Scene, camera: Any, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """Find rectangles around all that a camera would see of some parts (N, P) if nothing hid them.

        Returns:
            (N, 4) left, top, right, bottom [px]; all NaN where it would see nothing of them.
        """
        bounds = np.full((len(parts), 4), math.nan)
        for one, own in zip(bounds, parts, strict=True):
            v, u = np.nonzero(self.view(scene.only(own), camera, world_from_camera).cover)
            if len(u):
                one[:] = u.min() - 0.5, v.min() - 0.5, u.max() + 0.5, v.max() + 0.5
        return bounds

    def area(
        self, scene: Scene, camera: Any, world_from_camera: Matrix, parts: Mask, bounds: Sequence[float]
    ) -> int:
        """Count the pixels that some parts (P,) would fill if nothing hid them, within `bounds` of theirs."""
        if math.isnan(bounds[0]):
            return 0
        return int(np.count_nonzero(self.view(scene.only(parts), camera, world_from_camera).cover))

    def cover(self, view: View, owner_of_part: NDArray[np.int64], people: int, owners: int) -> Cover:
        """Count who covers whom, and find each person's visible pixels; arguments as in `count_cover`."""
        return count_cover(view.part, view.cover, owner_of_part, people, owners)


class PinholeRenderer(Renderer):
    """How a pinhole camera sees; its outlines go on beyond the image."""

    def __init__(self) -> None:
        # Poses in a camera's frame, of each scene that is still looked at: all boxes of a scene want them.
        self._poses: WeakKeyDictionary[Scene, dict[bytes, Matrix]] = WeakKeyDictionary()

    def view(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix) -> View:
        """Draw by the scene's renderer."""
        from peopleboy.sim.rendering.render import render  # here, as kinds are listed without PyBullet

        return render(
            scene.renderer, scene.physics, scene.table, camera, world_from_camera, scene.world_from_part,
            scene.person_of_part, scene.hidden,
        )  # fmt: skip

    def bounds(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """See `silhouette_bounds`."""
        return silhouette_bounds(camera, scene.table, self._before(scene, world_from_camera), parts)

    def area(
        self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask, bounds: Sequence[float]
    ) -> int:
        """See `silhouette_area`."""
        return silhouette_area(camera, scene.table, self._before(scene, world_from_camera), parts, bounds)

    def _before(self, scene: Scene, world_from_camera: Matrix) -> Matrix:
        """Return the poses (P, 4, 4) of a scene's parts in a camera's frame."""
        known, key = self._poses.setdefault(scene, {}), world_from_camera.tobytes()
        if key not in known:
            known[key] = invert_pose(world_from_camera) @ scene.world_from_part
        return known[key]


PINHOLE_RENDERER = PinholeRenderer()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RenderPass:
    """What one camera sees of a scene.

    Attributes:
        renderer: how it sees.
        scene: what.
        camera: its geometry.
        world_from_camera: (4, 4) its pose, optical frame.
        view: what lies behind its pixels.
    """

    renderer: Renderer
    scene: Scene
    camera: CameraGeometry
    world_from_camera: Matrix
    view: View

    def bounds(self, parts: Mask) -> Matrix:
        """The rectangles (N, 4) around some parts (N, P), as in `Renderer.bounds`."""
        return self.renderer.bounds(self.scene, self.camera, self.world_from_camera, parts)

    def area(self, parts: Mask, bounds: Sequence[float]) -> int:
        """Pixels of some parts (P,), as in `Renderer.area`."""
        return self.renderer.area(self.scene, self.camera, self.world_from_camera, parts, bounds)


def look(renderer: Renderer, scene: Scene, camera: CameraGeometry, world_from_camera: Matrix) -> RenderPass:
    """Let a camera see a scene."""
    view = renderer.view(scene, camera, world_from_camera)
    return RenderPass(
        renderer=renderer, scene=scene, camera=camera, world_from_camera=world_from_camera, view=view
    )
