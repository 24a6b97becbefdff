"""Rendering of camera views by one of two renderers, and outlines without occlusion."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix, Pinhole, invert_pose
from peopleboy.sim.geometry.vectors import Point, compose, cross, dot, from_each, minus
from peopleboy.sim.physics.physics_engine import Physics, Rasteriser
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.rendering.render_canvas import Lens, make_canvas, shade
from peopleboy.sim.rendering.skin_canvas import SeenSkins, draw_skins, see_skins, shade_skins, skin_bounds
from peopleboy.sim.rendering.view import NO_PERSON, Cover, View, count_cover, person_bits
from peopleboy.sim.shapes.bounds import EMPTY, shape_bounds, unite
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.skins import PosedSkins

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


# Surface normals from a depth image, for a renderer that does not provide them (numba kernels).

Depth = NDArray[np.float32]


@njit(cache=True, error_model="numpy")
def normals_from_depth(depth: Depth, lens: Lens, rotation: Array) -> Depth:
    """Estimate normals from the plane through each pixel and its neighbours that are nearest in depth.

    Normals are inaccurate on small objects.

    Args:
        depth: (H, W) [m] along the optical axis, inf for none.
        lens: ray directions of the pixels.
        rotation: (3, 3) world from camera.

    Returns:
        (H, W, 3) unit normals that face the camera, world frame; 0 where nothing is.
    """
    normals = np.zeros((lens.height, lens.width, 3), np.float32)
    for v in range(lens.height):
        for u in range(lens.width):
            if math.isfinite(depth[v, u]):
                here = _point(depth, lens, u, v)
                across = _step(here, _point(depth, lens, u - 1, v), _point(depth, lens, u + 1, v))
                down = _step(here, _point(depth, lens, u, v - 1), _point(depth, lens, u, v + 1))
                n = cross(across, down)
                size = math.sqrt(dot(n, n)) * (-1.0 if dot(n, here) > 0.0 else 1.0)
                for i in range(3):
                    along = rotation[i, 0] * n[0] + rotation[i, 1] * n[1] + rotation[i, 2] * n[2]
                    normals[v, u, i] = along / size if size != 0.0 else 0.0
    return normals


@njit(cache=True, error_model="numpy")
def _point(depth: Depth, lens: Lens, u: int, v: int) -> Point:
    """Return the point behind a pixel, optical frame; very far away outside the image or without surface."""
    z = 1e9
    if 0 <= u < lens.width and 0 <= v < lens.height and math.isfinite(depth[v, u]):
        z = float(depth[v, u])
    return (u - lens.centre_u) / lens.focal * z, (v - lens.centre_v) / lens.focal * z, z


@njit(cache=True, error_model="numpy")
def _step(here: Point, before: Point, after: Point) -> Point:
    """Return the difference to the neighbour that is nearer in depth, in the direction of `after`."""
    if abs(before[2] - here[2]) < abs(after[2] - here[2]):
        return minus(here, before)
    return minus(after, here)


_MOST_PEOPLE = 64


def render(scene: "Scene", camera: Pinhole, world_from_camera: Matrix) -> View:
    """Render a scene with its renderer: "raycast", exact and fast, or "bullet", an independent reference.

    Raises:
        BadInput: the renderer is unknown or cannot render this world, or a person's number is above 63.
    """
    persons, hidden = scene.person_of_part, scene.hidden
    if persons.max(initial=0) >= _MOST_PEOPLE:
        raise BadInput(f"person number {persons.max()}: a view supports at most {_MOST_PEOPLE} people")
    if scene.renderer == "raycast":
        skins = scene.seen_from(world_from_camera)[1] if scene.skins is not None else None
        return cast(scene.table, camera, world_from_camera, scene.world_from_part, persons, hidden, skins)
    if scene.renderer == "bullet":
        if not isinstance(scene.physics, Rasteriser):
            raise BadInput("renderer 'bullet' needs physics bullet; choose raycast")
        people = np.where(hidden, NO_PERSON, persons)
        removed = hidden & ~scene.physics.hidden_parts()  # the physics world knows all others
        return rasterise(scene.physics, camera, world_from_camera, people, removed)
    raise BadInput(f"unknown renderer {scene.renderer!r}; choose raycast or bullet")


def cast(
    table: ShapeTable,
    camera: Pinhole,
    world_from_camera: Matrix,
    world_from_part: Matrix,
    person_of_part: NDArray[np.int64],
    hidden: NDArray[np.bool_],
    skins: SeenSkins | None = None,
) -> View:
    """Render with the ray caster; arguments as the attributes of `Scene`; skins are in the camera's frame."""
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    canvas, bits = make_canvas(lens, _shadings(table, skins)), person_bits(person_of_part)
    camera_from_part = from_each(invert_pose(world_from_camera), world_from_part)
    draw(table, camera_from_part, hidden, bits, lens, canvas)
    if skins is not None:
        area = draw_skins(skins, hidden, bits, lens, canvas)
    shape = (lens.height, lens.width)
    part, depth = np.empty(shape, np.int32), np.empty(shape, np.float32)
    normal = np.empty((*shape, 3), np.float32)
    rotation = np.ascontiguousarray(world_from_camera[:3, :3])
    shade(table.surface_part, lens, canvas, rotation, part, depth, normal)
    if skins is not None:
        shade_skins(skins, area, lens, canvas, rotation, normal)
    return View(part, depth, normal, canvas.cover, canvas.surface)


def _shadings(table: ShapeTable, skins: SeenSkins | None) -> int:
    """Return the number of rows of a canvas's shading."""
    return len(table.surface_part) if skins is None else skins.posed.table.first_surface + 1


def rasterise(
    physics: Rasteriser,
    camera: Pinhole,
    world_from_camera: Matrix,
    person_of_part: NDArray[np.int64],
    removed: NDArray[np.bool_],
) -> View:
    """Render with TinyRenderer: the whole scene, then each person separately for the cover.

    Normals are computed from depths, and are inaccurate on small parts.
    """
    names = np.array([key.name for key in physics.parts()])
    rest = set(names[~removed].tolist()) if removed.any() else None
    part, depth = physics.camera_image(camera, world_from_camera, only=rest)
    cover = np.zeros(part.shape, np.uint64)
    for person in np.unique(person_of_part[person_of_part != NO_PERSON]):
        alone = set(names[person_of_part == person].tolist())
        silhouette, _ = physics.camera_image(camera, world_from_camera, only=alone)
        cover |= np.where(silhouette >= 0, np.uint64(1) << np.uint64(person), np.uint64(0))
    rotation = np.ascontiguousarray(world_from_camera[:3, :3])
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    return View(part, depth, normals_from_depth(depth, lens, rotation), cover)


# Size of an unoccluded person in the image.


def silhouette_bounds(
    camera: Pinhole,
    table: ShapeTable,
    camera_from_part: Matrix,
    parts: Mask,
    skins: SeenSkins | None = None,
) -> Array:
    """Return the rectangles around sets of parts in the image, ignoring occlusion.

    They may be outside the image. Points nearer than 0.05 m along the optical axis are ignored.

    Args:
        camera: the pinhole camera.
        table: the world's shapes.
        camera_from_part: (P, 4, 4) poses in the optical frame.
        parts: (N, P) which parts.
        skins: the world's skins, if there are any.

    Returns:
        (N, 4) left, top, right, bottom [px]; NaN for parts that are not in front of the camera.
    """
    found = np.empty((len(parts), 4))
    _bounds(table, camera_from_part, parts, found)
    if skins is not None:
        skin_bounds(skins, parts, found)
    (u, v), focal = camera.centre_px, camera.focal_px
    found[found[:, 0] > found[:, 2]] = math.nan
    bounds: Array = (u, v, u, v) + focal * found
    return bounds


def silhouette_area(
    camera: Pinhole,
    table: ShapeTable,
    camera_from_part: Matrix,
    parts: Mask,
    bounds: Sequence[float],
    skins: SeenSkins | None = None,
) -> int:
    """Count the pixels of parts (P,), ignoring occlusion and the image's border.

    The image is extended by its width and height beyond each border; arguments are as in `silhouette_bounds`,
    with its result for the parts.
    """
    if math.isnan(bounds[0]):
        return 0
    left, right = _within(bounds[0], bounds[2], camera.width)
    top, bottom = _within(bounds[1], bounds[3], camera.height)
    if left > right or top > bottom:
        return 0
    u, v = camera.centre_px
    lens = Lens(camera.focal_px, u - left, v - top, right - left + 1, bottom - top + 1)
    canvas = make_canvas(lens, _shadings(table, skins))
    bits = np.ones(len(parts), np.uint64)
    draw(table, camera_from_part, ~parts, bits, lens, canvas)
    if skins is not None:
        draw_skins(skins, ~parts, bits, lens, canvas)
    return int(np.count_nonzero(canvas.cover))


def _within(low: float, high: float, size: int) -> tuple[int, int]:
    """Return first and last pixel of an interval within the image and one image on either side."""
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
        if not wanted or table.is_stand_in[shape]:
            continue
        compose(camera_from_part[part], table.part_from_shape[shape], pose)
        first, end = table.triangle_range[shape]
        own = shape_bounds(table.kind[shape], table.size[shape], pose, table.triangles[first:end])
        for n in range(len(parts)):
            if parts[n, part]:
                before = (found[n, 0], found[n, 1], found[n, 2], found[n, 3])
                found[n, 0], found[n, 1], found[n, 2], found[n, 3] = unite(before, own)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, weakref_slot=True)
class Scene:
    """All visible shapes at an instant.

    Attributes:
        renderer: name of the renderer for pinhole cameras.
        physics: the world.
        table: its visible shapes.
        world_from_part: (P, 4, 4).
        person_of_part: (P,) number of the person that a part belongs to, -1 for none.
        hidden: (P,) absent parts.
        skins: skins at that instant; None if there are none.
    """

    renderer: str
    physics: Physics
    table: ShapeTable
    world_from_part: Matrix
    person_of_part: NDArray[np.int64]
    hidden: Mask
    skins: PosedSkins | None = None
    _seen: dict[bytes, tuple[Matrix, SeenSkins | None]] = field(default_factory=dict, init=False, repr=False)

    def seen_from(self, world_from_camera: Matrix) -> tuple[Matrix, SeenSkins | None]:
        """Return the poses (P, 4, 4) of all parts in a camera's frame, and the skins there.

        They are computed once for each camera, as its image, edges and boxes need them.
        """
        key = world_from_camera.tobytes()
        if key not in self._seen:
            camera_from_world = invert_pose(world_from_camera)
            skins = None if self.skins is None else see_skins(self.skins, camera_from_world)
            self._seen[key] = camera_from_world @ self.world_from_part, skins
        return self._seen[key]

    def without(self, parts: Mask) -> "Scene":
        """Return the scene without some parts (P,), such as those through which light passes."""
        return replace(self, hidden=self.hidden | parts)

    def only(self, parts: Mask) -> "Scene":
        """Return the scene with only some parts (P,), such as those of one person."""
        return replace(self, person_of_part=np.where(parts, 0, NO_PERSON), hidden=~parts)


class Renderer(ABC):
    """Renderer for cameras of one geometry.

    A subclass must define `view`. By default, outlines are computed from that, in whole pixels inside the
    image; override them if they can be computed more precisely or faster.
    """

    @abstractmethod
    def view(self, scene: Scene, camera: Any, world_from_camera: Matrix) -> View:
        """Render a camera's view of a scene; its pose is (4, 4), optical frame to world."""

    def bounds(self, scene: Scene, camera: Any, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """Return rectangles around sets of parts (N, P) in the image, ignoring occlusion.

        Returns:
            (N, 4) left, top, right, bottom [px]; all NaN for parts outside the view.
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
        """Count the pixels of some parts (P,) within their `bounds`, ignoring occlusion."""
        if math.isnan(bounds[0]):
            return 0
        return int(np.count_nonzero(self.view(scene.only(parts), camera, world_from_camera).cover))

    def cover(self, view: View, owner_of_part: NDArray[np.int64], people: int, owners: int) -> Cover:
        """Count occlusions between people, and their visible pixels; arguments as in `count_cover`."""
        return count_cover(view.part, view.cover, owner_of_part, people, owners)


class PinholeRenderer(Renderer):
    """Renderer for pinhole cameras; outlines continue beyond the image."""

    def view(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix) -> View:
        """Render with the scene's renderer."""
        return render(scene, camera, world_from_camera)

    def bounds(self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask) -> Matrix:
        """See `silhouette_bounds`."""
        poses, skins = scene.seen_from(world_from_camera)
        return silhouette_bounds(camera, scene.table, poses, parts, skins)

    def area(
        self, scene: Scene, camera: Pinhole, world_from_camera: Matrix, parts: Mask, bounds: Sequence[float]
    ) -> int:
        """See `silhouette_area`."""
        poses, skins = scene.seen_from(world_from_camera)
        return silhouette_area(camera, scene.table, poses, parts, bounds, skins)


PINHOLE_RENDERER = PinholeRenderer()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RenderPass:
    """The view of a scene by one camera.

    Attributes:
        renderer: renderer of the camera.
        scene: the scene.
        camera: geometry of the camera.
        world_from_camera: (4, 4) pose of the camera's optical frame.
        view: the rendered view.
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
    """Render a scene for a camera."""
    view = renderer.view(scene, camera, world_from_camera)
    return RenderPass(
        renderer=renderer, scene=scene, camera=camera, world_from_camera=world_from_camera, view=view
    )
