"""What a camera sees of the world, by one of two renderers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.geometry.products import from_each
from peopleboy.sim.physics.physics import Physics, Rasteriser
from peopleboy.sim.rendering.canvas import Lens, make_canvas, shade
from peopleboy.sim.rendering.depth_normals import normals_from_depth
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.rendering.view import NOBODY, View, person_bits
from peopleboy.sim.shapes.shape_table import ShapeTable

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
