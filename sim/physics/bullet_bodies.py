"""Which body has which name, which parts it has, and what PyBullet calls them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.physics.solid_shapes import PartKey
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Vector

Place = tuple[Vector, Quaternion]

AT_ORIGIN: Final[Place] = ((0.0, 0.0, 0.0), UPRIGHT)

_ROUNDING: Final = 1e-12

# Bullet takes the bits below these for groups of its own.
_FIRST_FREE_BIT = 6
_LAST_BIT = 30


@dataclass(slots=True, eq=False)
class BulletBody:
    """A named body.

    Attributes:
        name: unique.
        parts: the numbers of its base and of its links.
        ids: PyBullet's numbers, several for one part of more shapes than a PyBullet body holds; none as long
            as PyBullet need not know of it.
        joints: link that each joint moves, by the joint's name.
        base_from_inertia: the frame that PyBullet places, in the base's own frame.
        moves_by_itself: whether physics moves it.
        visible_links: id and link of all that is to be seen.
        group: collision group of its own, if it needed one.
        solid_links: id and link of all that rays and bodies meet.
        put_at: where a body of a file was put, unless physics moves it.
        hidden_at: where it will reappear if it is hidden.
        is_given: whether its shapes were given, not read from a file; then it is of one part.
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
        """The links that the named joints move.

        Raises:
            BadInput: it has no such joint.
        """
        for joint in joints:
            if joint not in self.joints:
                known = ", ".join(self.joints) or "none"
                raise BadInput(f"body {self.name!r} has no joint {joint!r}; it has: {known}")
        return [self.joints[joint] for joint in joints]


class BulletBodies:
    """All bodies of one world, by name, and their parts in the order of creation.

    Attributes:
        parts: what each part is.
        moving: the bodies that physics moves.
    """

    def __init__(self) -> None:
        self.parts: list[PartKey] = []
        self.moving: list[BulletBody] = []
        self._bodies: dict[str, BulletBody] = {}
        self._body_of_id: dict[int, BulletBody] = {}
        self._part_of_link: dict[tuple[int, int], int] = {}
        self._groups = 0

    def __iter__(self) -> Iterator[BulletBody]:
        return iter(self._bodies.values())

    def __getitem__(self, name: str) -> BulletBody:
        try:
            return self._bodies[name]
        except KeyError:
            known = ", ".join(self._bodies) or "none"
            raise BadInput(f"no body is called {name!r}; there are: {known}") from None

    def check_new(self, name: str) -> None:
        """Refuse a name that is taken.

        Raises:
            BadInput: it is.
        """
        if name in self._bodies:
            raise BadInput(f"body {name!r}: there is one already; choose another name")

    def add(self, body: BulletBody, link_names: Sequence[str]) -> None:
        """Take in a body whose base and links have these names."""
        self._bodies[body.name] = body
        if body.moves_by_itself:
            self.moving.append(body)
        self.parts.extend(PartKey(body.name, link - 1, name) for link, name in enumerate(link_names))
        self.know_ids(body)

    def know_ids(self, body: BulletBody) -> None:
        """Take in PyBullet's numbers of a body."""
        for number in body.ids:
            self._body_of_id[number] = body
            self._part_of_link.update({(number, link - 1): part for link, part in enumerate(body.parts)})

    def name_of(self, number: int) -> str:
        """Name of the body that PyBullet gave this number."""
        return self._body_of_id[number].name

    def part_of(self, number: int, link: int) -> int:
        """Number of the part that is this link of PyBullet's body of this number, -1 if there is none."""
        return self._part_of_link.get((number, link), -1)

    def parts_of(self, mask: NDArray[Any]) -> NDArray[np.int32]:
        """Part numbers in place of PyBullet's combined numbers of body and link, of any shape."""
        numbers, links = np.array(list(self._part_of_link)).reshape(-1, 2).T
        parts = np.full((numbers.max(initial=0) + 1, links.max(initial=0) + 2), -1, np.int32)
        parts[numbers, links + 1] = list(self._part_of_link.values())
        found = mask >= 0
        return np.where(found, parts[np.where(found, mask & 0xFFFFFF, 0), np.where(found, mask >> 24, 0)], -1)

    def new_group(self) -> int:
        """A collision group that no body has.

        Raises:
            BadInput: all are taken.
        """
        bit = _FIRST_FREE_BIT + self._groups
        if bit > _LAST_BIT:
            raise BadInput(f"rays can ignore at most {self._groups} different bodies in one world")
        self._groups += 1
        return 1 << bit


def as_unit(orientation: Quaternion) -> Quaternion:
    """Return a quaternion its length of 1, as PyBullet does."""
    x, y, z, w = orientation
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return orientation if abs(length - 1.0) < _ROUNDING else (x / length, y / length, z / length, w / length)


def as_units(orientations: ArrayLike) -> NDArray[np.float64]:
    """Do that with N quaternions (N, 4)."""
    given = np.asarray(orientations, np.float64)
    x, y, z, w = given.T
    lengths = np.sqrt(x * x + y * y + z * z + w * w)[:, None]
    return np.where(abs(lengths - 1.0) < _ROUNDING, given, given / lengths)
