"""Bodies by name: their parts, their PyBullet ids, and ray tests without PyBullet."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.physics_engine import BodiesByName
from peopleboy.sim.physics.solid_shapes import Array, PartKey, PlacedBodies, cast, entered_at
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, Vector

Place = tuple[Vector, Quaternion]

AT_ORIGIN: Final[Place] = ((0.0, 0.0, 0.0), UPRIGHT)

_ROUNDING: Final = 1e-12

# Bullet uses the lower bits for its built-in groups.
_FIRST_FREE_BIT = 6
_LAST_BIT = 30


@dataclass(slots=True, eq=False)
class BulletBody:
    """A named body.

    Attributes:
        name: unique.
        parts: the numbers of its base and of its links.
        ids: PyBullet's numbers, several for one part with more shapes than a PyBullet body can have; none as
            long as PyBullet does not need the body.
        joints: link that each joint moves, by the joint's name.
        base_from_inertia: the frame that PyBullet places, in the base frame.
        moves_by_itself: whether physics moves it.
        visible_links: id and link of visible links.
        group: separate collision group, if needed.
        solid_links: id and link of links that block rays and bodies.
        put_at: pose of a body of a file, unless physics moves it.
        hidden_at: pose at which it will reappear if it is hidden.
        is_given: whether its shapes were given, not read from a file; then it has one part.
    """

    name: str
    parts: range
    ids: tuple[int, ...] = ()
    joints: Mapping[str, int] = field(default_factory=dict)
    base_from_inertia: Place = AT_ORIGIN
    moves_by_itself: bool = False
    visible_links: Sequence[tuple[int, int]] = ()
    solid_links: Sequence[tuple[int, int]] = ()
    group: int | None = None
    put_at: Place | None = None
    hidden_at: Place | None = None
    is_given: bool = False

    def links_of(self, joints: Sequence[str]) -> list[int]:
        """Return the links that the named joints move.

        Raises:
            BadInput: the body has no such joint.
        """
        for joint in joints:
            if joint not in self.joints:
                known = f"choose from {', '.join(self.joints)}" if self.joints else "the body has no joints"
                raise BadInput(f"body {self.name!r}: unknown joint {joint!r}; {known}")
        return [self.joints[joint] for joint in joints]


class BulletBodies:
    """All bodies of one world, by name, and their parts in the order of creation.

    Args:
        parts: keys of all parts; those of new bodies are appended.

    Attributes:
        parts: as given.
        by_name: the bodies.
        moving: the bodies that physics moves.
    """

    def __init__(self, parts: list[PartKey]) -> None:
        self.parts = parts
        self.by_name = BodiesByName[BulletBody]()
        self.moving: list[BulletBody] = []
        self._body_of_id: dict[int, BulletBody] = {}
        self._part_of_link: dict[tuple[int, int], int] = {}
        self._groups = 0

    def __iter__(self) -> Iterator[BulletBody]:
        return iter(self.by_name.values())

    def __getitem__(self, name: str) -> BulletBody:
        return self.by_name[name]

    def add(self, body: BulletBody, link_names: Sequence[str]) -> None:
        """Add a body with names of its base and links."""
        self.by_name[body.name] = body
        if body.moves_by_itself:
            self.moving.append(body)
        self.parts.extend(PartKey(body.name, link - 1, name) for link, name in enumerate(link_names))
        self.know_ids(body)

    def know_ids(self, body: BulletBody) -> None:
        """Store PyBullet's numbers of a body."""
        for number in body.ids:
            self._body_of_id[number] = body
            self._part_of_link.update({(number, link - 1): part for link, part in enumerate(body.parts)})

    def name_of(self, number: int) -> str:
        """Return the name of the body with a PyBullet number."""
        return self._body_of_id[number].name

    def part_of(self, number: int, link: int) -> int:
        """Return the number of the part for a link of a PyBullet body, -1 for none."""
        return self._part_of_link.get((number, link), -1)

    def parts_of(self, mask: NDArray[Any]) -> NDArray[np.int32]:
        """Convert PyBullet's combined numbers of body and link to part numbers; arrays of any shape."""
        numbers, links = np.array(list(self._part_of_link)).reshape(-1, 2).T
        parts = np.full((numbers.max(initial=0) + 1, links.max(initial=0) + 2), -1, np.int32)
        parts[numbers, links + 1] = list(self._part_of_link.values())
        found = mask >= 0
        return np.where(found, parts[np.where(found, mask & 0xFFFFFF, 0), np.where(found, mask >> 24, 0)], -1)

    def new_group(self) -> int:
        """Return an unused collision group.

        Raises:
            BadInput: all are taken.
        """
        bit = _FIRST_FREE_BIT + self._groups
        if bit > _LAST_BIT:
            raise BadInput(f"rays can ignore at most {self._groups} different bodies in one world")
        self._groups += 1
        return 1 << bit


def as_unit(orientation: Quaternion) -> Quaternion:
    """Return a quaternion normalised to length 1, as PyBullet does."""
    x, y, z, w = orientation
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return orientation if abs(length - 1.0) < _ROUNDING else (x / length, y / length, z / length, w / length)


def as_units(orientations: ArrayLike) -> NDArray[np.float64]:
    """Return N quaternions (N, 4) normalised to length 1."""
    given = np.asarray(orientations, np.float64)
    x, y, z, w = given.T
    lengths = np.sqrt(x * x + y * y + z * z + w * w)[:, None]
    return np.where(abs(lengths - 1.0) < _ROUNDING, given, given / lengths)


# Ray casting without PyBullet: exact for bodies of given shapes, and boxes around the others.

_NONE: Final = -1


class GivenBodies:
    """Bodies by name with externally set poses; rays are tested against the exact shapes."""

    def __init__(self) -> None:
        self._rows: dict[str, int] = {}
        self._part_of_row = np.zeros(0, np.int64)
        self._bodies = PlacedBodies()  # solid bodies have a part
        self._has_moved = np.zeros(0, np.bool_)  # since `moved_poses`

    def add(self, name: str, part: int, solid: Sequence[Shape]) -> None:
        """Add a body, with its part's number in the world, and its solid shapes."""
        row = self._rows[name] = self._bodies.add()
        self._part_of_row, self._has_moved = (
            np.append(self._part_of_row, part),
            np.append(self._has_moved, True),
        )
        if solid:
            self._bodies.add_part(row, np.eye(4), solid)

    def put(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """Place a body's frame at a position [m] and a quaternion of any length, world frame."""
        row = self._rows[name]
        self._bodies.put(row, position, as_unit(orientation))
        self._has_moved[row] = True

    def put_all(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """Place N bodies at (N, 3) and (N, 4)."""
        rows = list(map(self._rows.__getitem__, names))
        self._bodies.put(rows, positions, as_units(orientations))
        self._has_moved[rows] = True

    def place(self, name: str) -> Place:
        """Return position [m] and unit quaternion of a body's frame in the world."""
        x, y, z, i, j, k, w = self._bodies.places[self._rows[name]].tolist()
        return (x, y, z), (i, j, k, w)

    def moved_poses(self) -> tuple[NDArray[np.int64], Array]:
        """Return numbers (M,) and poses (M, 4, 4) of the parts that were placed since the last call."""
        rows = np.flatnonzero(self._has_moved)
        self._has_moved[rows] = False
        places = self._bodies.places[rows]
        return self._part_of_row[rows], pose_matrices(places[:, :3], places[:, 3:])

    def cast_rays(self, starts: Array, ends: Array, ignore: str | None) -> tuple[Array, NDArray[np.int64]]:
        """Find the nearest hits of rays on these bodies: shapes from outside, triangles from both sides.

        Args:
            starts: (R, 3) [m] world frame.
            ends: (R, 3) [m].
            ignore: name of a body that rays ignore; None for none.

        Returns:
            fraction: (R,) hit distance as a fraction of the ray, 1 without a hit.
            part: (R,) number of the hit part, -1 for none.
        """
        bodies, solids = self._bodies.now()
        passed = _NONE if ignore is None else self._rows.get(ignore, _NONE)
        fraction, solid = cast(starts, ends, bodies, solids, passed)
        return fraction, np.append(self._part_of_row[bodies.of_part], _NONE)[solid]


Link = tuple[int, int]


class SolidBoxes:
    """Axis-aligned boxes around the solid links of bodies, updated when rays are cast.

    Args:
        box_of: returns the least and the greatest corner [m] of the box around a body's link, world frame.
    """

    def __init__(self, box_of: Callable[[int, int], tuple[Vector, Vector]]) -> None:
        self._box_of = box_of
        self._boxes = np.zeros((0, 2, 3))
        self._links: dict[str, Sequence[Link]] = {}
        self._rows: dict[str, tuple[int, int]] = {}
        self._stale: set[str] = set()

    def add(self, name: str, links: Sequence[Link]) -> None:
        """Add a body with its solid links."""
        first = len(self._boxes)
        self._boxes = np.concatenate([self._boxes, np.zeros((len(links), 2, 3))])
        self._links[name] = links
        self._rows[name] = (first, first + len(links))
        self._stale.add(name)

    def forget(self, name: str) -> None:
        """Mark a moved body for update at the next ray cast."""
        self._stale.add(name)

    def find_near(self, starts: Array, ends: Array, ignore: str | None) -> NDArray[np.int64]:
        """Return the numbers of rays that pass within 1 mm of a box of these bodies, except of `ignore`.

        Args:
            starts: (R, 3) [m] world frame.
            ends: (R, 3) [m].
            ignore: name of a body, or None.
        """
        for name in self._stale - {ignore}:
            first, _ = self._rows[name]
            for row, link in enumerate(self._links[name], first):
                self._boxes[row] = self._box_of(*link)
        self._stale &= {ignore}
        passed = (0, 0) if ignore is None else self._rows.get(ignore, (0, 0))
        return np.flatnonzero(_reach(starts, ends, self._boxes, passed))


@njit(cache=True)
def _reach(starts: Array, ends: Array, boxes: Array, passed: tuple[int, int]) -> NDArray[np.bool_]:
    """Return (R,) whether each ray reaches a box, except boxes of the rows `passed`."""
    found = np.zeros(len(starts), np.bool_)
    for ray in range(len(starts)):
        for row in range(len(boxes)):
            if not passed[0] <= row < passed[1] and entered_at(starts[ray], ends[ray], boxes[row]) <= 1.0:
                found[ray] = True
                break
    return found
