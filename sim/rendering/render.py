"""What a camera sees of the world, by one of two renderers."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.geometry.vectors import Point, cross, dot, from_each, minus
from peopleboy.sim.physics.physics_engine import Physics, Rasteriser
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.rendering.render_canvas import Lens, make_canvas, shade
from peopleboy.sim.rendering.view import NOBODY, View, person_bits
from peopleboy.sim.shapes.shape_table import ShapeTable

# Surface normals from an image of depths alone, for a renderer that gives no more (numba kernels).

Array = NDArray[np.float64]
Depth = NDArray[np.float32]


@njit(cache=True, error_model="numpy")
def normals_from_depth(depth: Depth, lens: Lens, rotation: Array) -> Depth:
    """Take the plane through each pixel and its neighbours that are nearest to it in depth.

    Rough on things of few pixels.

    Args:
        depth: (H, W) [m] along the optical axis, inf where nothing is.
        lens: where pixels look.
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
    """What lies behind a pixel, optical frame; very far off outside the image or where nothing is."""
    z = 1e9
    if 0 <= u < lens.width and 0 <= v < lens.height and math.isfinite(depth[v, u]):
        z = float(depth[v, u])
    return (u - lens.centre_u) / lens.focal * z, (v - lens.centre_v) / lens.focal * z, z


@njit(cache=True, error_model="numpy")
def _step(here: Point, before: Point, after: Point) -> Point:
    """The difference to one of two neighbours, whichever is nearer in depth, in the direction of `after`."""
    if abs(before[2] - here[2]) < abs(after[2] - here[2]):
        return minus(here, before)
    return minus(after, here)


_MOST_PEOPLE = 64


def render(
    name: str,
    physics: Physics,
    table: ShapeTable,
    camera: Pinhole,
    world_from_camera: Matrix,
    world_from_part: Matrix,
    person_of_part: NDArray[np.int64],
    hidden: NDArray[np.bool_],
) -> View:
    """Draw the world by the renderer of that name.

    Args:
        name: "raycast", exact and quick, or "bullet", PyBullet's TinyRenderer, an independent reference.
        physics: the world.
        table: its visible shapes.
        camera: the pinhole camera.
        world_from_camera: (4, 4) optical frame to world.
        world_from_part: (P, 4, 4), used by "raycast".
        person_of_part: (P,) number of the person that a part belongs to, 0..63, -1 for none.
        hidden: (P,) parts that are not there.

    Raises:
        BadInput: no renderer has that name, or it cannot draw this world; or a person's number is above 63.
    """
    if person_of_part.max(initial=0) >= _MOST_PEOPLE:
        raise BadInput(
            f"person number {person_of_part.max()}: a view tells at most {_MOST_PEOPLE} people apart"
        )
    if name == "raycast":
        return cast(table, camera, world_from_camera, world_from_part, person_of_part, hidden)
    if name == "bullet":
        if not isinstance(physics, Rasteriser):
            raise BadInput("renderer 'bullet': draws worlds of PyBullet only; choose raycast")
        return rasterise(physics, camera, world_from_camera, np.where(hidden, NOBODY, person_of_part))
    raise BadInput(f"renderer {name!r}: there is none of that name; choose raycast or bullet")


def cast(
    table: ShapeTable,
    camera: Pinhole,
    world_from_camera: Matrix,
    world_from_part: Matrix,
    person_of_part: NDArray[np.int64],
    hidden: NDArray[np.bool_],
) -> View:
    """Draw by the ray caster; arguments as in `render`."""
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    return cast_window(table, lens, world_from_camera, world_from_part, person_of_part, hidden)


def cast_window(
    table: ShapeTable,
    lens: Lens,
    world_from_camera: Matrix,
    world_from_part: Matrix,
    person_of_part: NDArray[np.int64],
    hidden: NDArray[np.bool_],
) -> View:
    """Draw by the ray caster what a lens sees, which need not look from its image's middle.

    The pose may be that of a camera in a mirror, which turns left and right round: meshes are
    inside out then.
    """
    canvas = make_canvas(lens, len(table.surface_part))
    camera_from_part = from_each(invert_pose(world_from_camera), world_from_part)
    draw(table, camera_from_part, hidden, person_bits(person_of_part), lens, canvas)
    shape = (lens.height, lens.width)
    part, depth = np.empty(shape, np.int32), np.empty(shape, np.float32)
    normal = np.empty((*shape, 3), np.float32)
    rotation = np.ascontiguousarray(world_from_camera[:3, :3])
    shade(table.surface_part, lens, canvas, rotation, part, depth, normal)
    return View(part, depth, normal, canvas.cover, canvas.surface)


def rasterise(
    physics: Rasteriser, camera: Pinhole, world_from_camera: Matrix, person_of_part: NDArray[np.int64]
) -> View:
    """Draw by TinyRenderer: everything at once, then each person alone for the cover.

    Normals come from differences of depth, and are rough on small parts.
    """
    part, depth = physics.camera_image(camera, world_from_camera)
    cover = np.zeros(part.shape, np.uint64)
    names = np.array([key.name for key in physics.parts()])
    for person in np.unique(person_of_part[person_of_part != NOBODY]):
        alone = set(names[person_of_part == person].tolist())
        silhouette, _ = physics.camera_image(camera, world_from_camera, only=alone)
        cover |= np.where(silhouette >= 0, np.uint64(1) << np.uint64(person), np.uint64(0))
    rotation = np.ascontiguousarray(world_from_camera[:3, :3])
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    return View(part, depth, normals_from_depth(depth, lens, rotation), cover)
