"""Convert places, the robot and people to simple solids for drawing."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.scenarios.drawing.palette import Rgb
from peopleboy.sim.physics.urdf import read_urdf
from peopleboy.sim.places.extent import fixture_extent, shape_extent
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, ShapeKind, Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Solid:
    """A box, cylinder or ball.

    Attributes:
        kind: BOX, CYLINDER or SPHERE, with sizes as in `Shape`.
        size: [m].
        position, orientation: in the frame of the drawing; quaternions are x, y, z, w.
        colour: sRGB.
    """

    kind: ShapeKind
    size: Vector
    position: Vector
    orientation: Quaternion
    colour: Rgb


def group_fixtures(fixtures: Iterable[Fixture]) -> dict[str, list[Fixture]]:
    """Group fixtures into floor, ceiling, walls and objects, each shown or hidden as a whole."""
    groups: dict[str, list[Fixture]] = {}
    for fixture in fixtures:
        kind = fixture.name.replace("/", "_").split("_")[0]
        group = {"floor": "floor", "ceiling": "ceiling", "wall": "walls", "door": "walls"}.get(kind, "things")
        groups.setdefault(group, []).append(fixture)
    return groups


def fixture_solids(fixture: Fixture) -> Iterator[Solid]:
    """Return a fixture's solids in the world frame; a URDF or mesh is replaced by its bounding boxes."""
    if fixture.part is None:
        (low, high), material = fixture_extent(fixture), fixture.material
        yield _box((low + high) / 2.0, high - low, _srgb(material))
        return
    turn = Rotation.from_quat(fixture.orientation)
    for shape in fixture.part.shapes:
        if shape.kind is ShapeKind.PLANE:
            continue
        kind, size, position = _simplify(shape)
        yield Solid(
            kind=kind,
            size=size,
            position=_vector(turn.apply(position) + fixture.position),
            orientation=_quaternion(turn * Rotation.from_quat(shape.orientation)),
            colour=_srgb(fixture.part.material),
        )


def urdf_solids(path: Path) -> list[Solid]:
    """Return the visual solids of a URDF in the frame of its root link, with all joints at zero."""
    return [
        Solid(
            kind=kind,
            size=size,
            position=position,
            orientation=visible.shape.orientation,
            colour=_bytes(visible.rgb),
        )
        for visible in read_urdf(path)
        for kind, size, position in [_simplify(visible.shape)]
    ]


def _simplify(shape: Shape) -> tuple[ShapeKind, Vector, Vector]:
    """Return kind, size and position in the part's frame; a mesh becomes a box, a capsule a cylinder."""
    if shape.kind is ShapeKind.CAPSULE:
        length, radius, _ = shape.size
        return ShapeKind.CYLINDER, (length + 2.0 * radius, radius, 0.0), shape.position
    if shape.kind is not ShapeKind.MESH:
        return shape.kind, shape.size, shape.position
    low, high = shape_extent(shape)
    middle = Rotation.from_quat(shape.orientation).apply((low + high) / 2.0)
    return ShapeKind.BOX, _vector(high - low), _vector(np.array(shape.position) + middle)


def _box(centre: np.ndarray, size: np.ndarray, colour: Rgb) -> Solid:
    return Solid(
        kind=ShapeKind.BOX, size=_vector(size), position=_vector(centre), orientation=UPRIGHT, colour=colour
    )


def _srgb(material: Material | None) -> Rgb:
    """Convert linear reflectance to sRGB."""
    red, green, blue = (0.5, 0.5, 0.5) if material is None else material.rgb
    return _bytes((red ** (1 / 2.2), green ** (1 / 2.2), blue ** (1 / 2.2)))


def _bytes(shares: tuple[float, float, float]) -> Rgb:
    red, green, blue = (round(255 * min(max(share, 0.0), 1.0)) for share in shares)
    return red, green, blue


def _vector(numbers: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in numbers)
    return x, y, z


def _quaternion(rotation: Rotation) -> Quaternion:
    x, y, z, w = (float(number) for number in rotation.as_quat())
    return x, y, z, w


Floats = NDArray[np.float64]

# Indices of the COCO keypoints.
_EARS, _SHOULDERS, _ELBOWS, _WRISTS = (3, 4), (5, 6), (7, 8), (9, 10)
_HIPS, _KNEES, _ANKLES = (11, 12), (13, 14), (15, 16)

# Radii in shares of the height from ankles to ears: typical proportions, not those of the simulated body.
_LIMBS: Final[tuple[tuple[tuple[int, int], tuple[int, int], float], ...]] = (
    (_SHOULDERS, _ELBOWS, 0.033),
    (_ELBOWS, _WRISTS, 0.025),
    (_HIPS, _KNEES, 0.050),
    (_KNEES, _ANKLES, 0.035),
    (_SHOULDERS, _HIPS, 0.065),
)
_ACROSS_RADIUS: Final = 0.050
_TRUNK_RADIUS: Final = 0.075
_HEAD_RADIUS: Final = 0.058


@dataclass(frozen=True, slots=True, eq=False)
class Capsules:
    """K capsules, each along its own z axis from the centre of one cap to that of the other.

    Attributes:
        start: (K, 3) [m] world frame.
        quaternion: (K, 4) x, y, z, w that turns z to the capsule's axis.
        length: (K,) [m] between the caps' centres.
        radius: (K,) [m].
    """

    start: Floats
    quaternion: Floats
    length: Floats
    radius: Floats


NO_CAPSULES: Final = Capsules(np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0), np.zeros(0))


def body_capsules(joints: Floats) -> Capsules:
    """Return limbs, trunk and head of a person as capsules, from its joints (17, 3) [m]."""
    ends = [
        (joints[a], joints[b], radius)
        for one, other, radius in _LIMBS
        for a, b in zip(one, other, strict=True)
    ]
    shoulders, hips = joints[list(_SHOULDERS)], joints[list(_HIPS)]
    head = joints[list(_EARS)].mean(axis=0)
    ends.append((shoulders[0], shoulders[1], _ACROSS_RADIUS))
    ends.append((hips[0], hips[1], _ACROSS_RADIUS))
    ends.append(
        (shoulders.mean(axis=0) + 0.18 * (hips - shoulders).mean(axis=0), hips.mean(axis=0), _TRUNK_RADIUS)
    )
    ends.append(
        (
            head + 0.12 * (shoulders.mean(axis=0) - head),
            head + 0.14 * (head - shoulders.mean(axis=0)),
            _HEAD_RADIUS,
        )
    )
    start, end = np.array([a for a, _, _ in ends]), np.array([b for _, b, _ in ends])
    axis = end - start
    length = np.linalg.norm(axis, axis=1)
    return Capsules(start, turn_z_to(axis), length, np.array([r for _, _, r in ends]) * _size(joints))


def turn_z_to(axis: Floats) -> Floats:
    """Return the shortest rotations (K, 4) x, y, z, w from z to axes (K, 3); identity for length 0."""
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    x, y, z = (axis / np.where(length > 0.0, length, 1.0)).T
    z = np.where(length[:, 0] > 0.0, z, 1.0)
    turns = np.stack([-y, x, np.zeros_like(x), 1.0 + z], axis=1)
    turns[z < -1.0 + 1e-9] = (1.0, 0.0, 0.0, 0.0)
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return turns


def _size(joints: Floats) -> float:
    """Return the standing height [m] of a person up to the ears: legs, trunk and neck."""
    chain = [joints[list(pair)].mean(axis=0) for pair in (_ANKLES, _KNEES, _HIPS, _SHOULDERS, _EARS)]
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(chain)))
