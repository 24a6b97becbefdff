"""Extents of fixtures: boxes around shapes and URDF files, and overlap of upright boxes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.urdf import data_folder, find_urdf, is_in_data, mesh_files, read_urdf
from peopleboy.sim.places.moving import Stance
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.shapes import Shape, ShapeKind, load_triangles

Array = NDArray[np.float64]

Extent = NDArray[np.float64]  # (2, 3) [m]: lowest and highest x, y, z

_REMEMBERED = (
    1024  # fixtures: those of several places, as a place is built again for each try of a random world
)
_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


@lru_cache(maxsize=_REMEMBERED)
def fixture_extent(fixture: Fixture) -> Extent:
    """Return the box around a fixture in the world frame: exact for boxes, and never too small.

    Raises:
        BadInput: a URDF or a mesh cannot be read.
    """
    world = [_moved(extent, fixture.position, fixture.orientation) for extent in shape_extents(fixture)]
    extent = np.round(_around(np.concatenate(world)), 9)
    extent.setflags(write=False)
    return extent


def shape_extents(fixture: Fixture) -> list[Extent]:
    """Return the boxes around each shape of a fixture, in the fixture's frame; a URDF is one box.

    Raises:
        BadInput: a URDF or a mesh cannot be read.
    """
    if fixture.part is not None:
        return [_moved(shape_extent(s), s.position, s.orientation) for s in fixture.part.shapes]
    return [urdf_extent(find_urdf(str(fixture.urdf))) * fixture.scale]


def shape_extent(shape: Shape) -> Extent:
    """Return the box around a shape in its own frame.

    Raises:
        BadInput: a plane has no extent, or a mesh cannot be read.
    """
    a, b, _ = shape.size
    if shape.kind == ShapeKind.MESH:
        scaled: Extent = mesh_extent(Path(str(shape.mesh))) * np.array(shape.size)
        return scaled
    if shape.kind == ShapeKind.PLANE:
        raise BadInput("a plane has no extent; use a box")
    half = {
        ShapeKind.SPHERE: (a, a, a),
        ShapeKind.CAPSULE: (b, b, a / 2.0 + b),
        ShapeKind.CYLINDER: (b, b, a / 2.0),
        ShapeKind.BOX: tuple(side / 2.0 for side in shape.size),
    }[shape.kind]
    return np.array([half, half]) * [[-1.0], [1.0]]


@cache
def mesh_extent(path: Path) -> Extent:
    """Return the box around a mesh file.

    Raises:
        BadInput: the file cannot be read as a mesh.
    """
    corners = load_triangles(path).reshape(-1, 3)
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


@cache
def urdf_extent(path: Path) -> Extent:
    """Return the box around all visible shapes of a URDF, with all links in their rest pose.

    Raises:
        BadInput: the file is not a URDF with shapes, or names a mesh outside its own folder.
    """
    _check_meshes(path)
    shapes = [visible.shape for visible in read_urdf(path)]
    if not shapes:
        raise BadInput(f"{path} is not furniture: it has no visible shapes")
    return _around(np.concatenate([_moved(shape_extent(s), s.position, s.orientation) for s in shapes]))


def _check_meshes(path: Path) -> None:
    """Check that meshes are in the file's folder, or in pybullet_data if the file is there."""
    home = data_folder() if is_in_data(path) else path.parent
    for name in mesh_files(path):
        if not (path.parent / name).resolve().is_relative_to(home.resolve()):
            raise BadInput(f"{path}: mesh {name!r} is outside the file's folder")


def _moved(extent: Extent, position: object, orientation: object) -> Extent:
    return _placed(extent, pose_matrices(np.asarray(position, float), np.asarray(orientation, float)))


def _placed(extent: Extent, pose: NDArray[np.float64]) -> Extent:
    corners = extent[0] + _CORNERS * (extent[1] - extent[0])
    return _around(corners @ pose[:3, :3].T + pose[:3, 3])


def _around(points: NDArray[np.float64]) -> Extent:
    return np.array([points.min(axis=0), points.max(axis=0)])


# Upright boxes, rotated about the vertical: overlap, and distance to points.


@dataclass(frozen=True, slots=True, eq=False)
class BoxSet:
    """N upright boxes.

    Attributes:
        centre: (N, 3) [m] world frame.
        half: (N, 3) [m] half of their sides, along their own axes.
        heading: (N,) [rad] direction of their own x axis.
    """

    centre: Array
    half: Array
    heading: Array

    def moved(self, stance: Stance) -> "BoxSet":
        """Transform boxes from a thing's frame to the world, for a pose of the thing."""
        return BoxSet(stance.place(self.centre), self.half, self.heading + stance.heading_rad)

    def between(self, low_m: float, high_m: float) -> "BoxSet":
        """Return the boxes that overlap a span of heights."""
        bottom, top = self.centre[:, 2] - self.half[:, 2], self.centre[:, 2] + self.half[:, 2]
        kept = (bottom < high_m) & (top > low_m)
        return BoxSet(self.centre[kept], self.half[kept], self.heading[kept])

    def distance(self, point: tuple[float, float]) -> float:
        """Return the distance of a floor point [m] to the nearest box; 0 inside, infinite without boxes."""
        if not len(self.centre):
            return np.inf
        gap = np.abs(_own(np.array(point) - self.centre[:, :2], self.heading)) - self.half[:, :2]
        return float(np.hypot(*np.maximum(gap, 0.0).T).min())


def boxes_of(fixtures: Sequence[Fixture], origin: Stance | None = None) -> BoxSet:
    """Return the boxes around all solid shapes of fixtures, in the world or in the frame of a thing.

    Args:
        fixtures: upright fixtures, rotated about the vertical only.
        origin: frame for the boxes; None for the world.
    """
    found = [
        (extent.mean(axis=0), (extent[1] - extent[0]) / 2.0, _stance_of(fixture))
        for fixture in fixtures
        if fixture.is_solid
        for extent in shape_extents(fixture)
    ]
    centre = np.array([box[0] if origin else box[2].place(box[0]) for box in found]).reshape(-1, 3)
    heading = np.array([0.0 if origin else box[2].heading_rad for box in found])
    return BoxSet(centre, np.array([box[1] for box in found]).reshape(-1, 3), heading)


def overlaps(a: BoxSet, b: BoxSet, by_m: float) -> NDArray[np.bool_]:
    """Return (N, M) whether each box of one set penetrates each of the other by more than by_m [m].

    Two boxes are separate if an axis of either separates them (separating axis theorem).
    """
    gap = b.centre[None] - a.centre[:, None]
    deep = a.half[:, None, 2] + b.half[None, :, 2] - np.abs(gap[..., 2]) > by_m
    for boxes, shape in ((a, (-1, 1)), (b, (1, -1))):
        for turn in (0.0, np.pi / 2.0):
            angle = boxes.heading.reshape(shape) + turn
            apart = np.abs(gap[..., 0] * np.cos(angle) + gap[..., 1] * np.sin(angle))
            deep &= _reach(a, angle, (-1, 1)) + _reach(b, angle, (1, -1)) - apart > by_m
    return deep


def _reach(boxes: BoxSet, angle: Array, shape: tuple[int, int]) -> Array:
    """Return the extent of boxes from their centre in a direction."""
    own = angle - boxes.heading.reshape(shape)
    x, y = boxes.half[:, 0].reshape(shape), boxes.half[:, 1].reshape(shape)
    return np.asarray(x * np.abs(np.cos(own)) + y * np.abs(np.sin(own)))


def _own(offset: Array, heading: Array) -> Array:
    """Transform world offsets to (N, 2) in frames with headings (N,)."""
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([c * offset[:, 0] + s * offset[:, 1], c * offset[:, 1] - s * offset[:, 0]], axis=1)


def _stance_of(fixture: Fixture) -> Stance:
    _, _, z, w = fixture.orientation
    return Stance(fixture.position, 2.0 * float(np.arctan2(z, w)))
