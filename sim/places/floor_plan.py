"""Floor plans: walkable rectangles, the walls around them, and the doors in the walls."""

import math
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from typing import Annotated

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.settings import Coordinate, Word

# Axis-aligned rectangles on the floor: intersection and difference.

CLOSE_M = 1e-9  # rectangles within this distance touch


@dataclass(frozen=True, slots=True)
class Rectangle:
    """An upright rectangle on the floor [m], world frame."""

    min_x: float
    min_y: float
    max_x: float
    max_y: float

    @property
    def is_empty(self) -> bool:
        """Whether its area is empty."""
        return self.max_x - self.min_x <= CLOSE_M or self.max_y - self.min_y <= CLOSE_M

    @property
    def centre(self) -> tuple[float, float]:
        """Centre (x, y) [m]."""
        return (self.min_x + self.max_x) / 2.0, (self.min_y + self.max_y) / 2.0

    @property
    def longer_side(self) -> float:
        """Length of its longer side [m]."""
        return max(self.max_x - self.min_x, self.max_y - self.min_y)

    @property
    def area(self) -> float:
        """Area [m2]."""
        return (self.max_x - self.min_x) * (self.max_y - self.min_y)

    def grown(self, margin_m: float) -> "Rectangle":
        """Return the rectangle with every side moved outward by margin_m; inward if it is negative."""
        return Rectangle(
            self.min_x - margin_m, self.min_y - margin_m, self.max_x + margin_m, self.max_y + margin_m
        )

    def meets(self, other: "Rectangle") -> bool:
        """Return whether the interiors of the two overlap."""
        return not self.cut(other).is_empty

    def cut(self, other: "Rectangle") -> "Rectangle":
        """Return the intersection, which may be empty."""
        return Rectangle(
            max(self.min_x, other.min_x),
            max(self.min_y, other.min_y),
            min(self.max_x, other.max_x),
            min(self.max_y, other.max_y),
        )

    def without(self, hole: "Rectangle") -> "tuple[Rectangle, ...]":
        """Subtract a hole; return at most four rectangles that do not overlap."""
        cut = self.cut(hole)
        if cut.is_empty:
            return (self,)
        pieces = (
            Rectangle(self.min_x, self.min_y, cut.min_x, self.max_y),
            Rectangle(cut.max_x, self.min_y, self.max_x, self.max_y),
            Rectangle(cut.min_x, self.min_y, cut.max_x, cut.min_y),
            Rectangle(cut.min_x, cut.max_y, cut.max_x, self.max_y),
        )
        return tuple(piece for piece in pieces if not piece.is_empty)

    def contains(self, x: float, y: float) -> bool:
        """Whether a point lies inside or on the edge."""
        return self.min_x <= x <= self.max_x and self.min_y <= y <= self.max_y


def subtract(block: Rectangle, holes: tuple[Rectangle, ...]) -> tuple[Rectangle, ...]:
    """Cut all holes out of a rectangle; the pieces do not overlap."""
    pieces: tuple[Rectangle, ...] = (block,)
    for hole in holes:
        pieces = tuple(rest for piece in pieces for rest in piece.without(hole))
    return pieces


def lengthened(block: Rectangle, piece: Rectangle) -> Rectangle | None:
    """Return the union of two rectangles that do not overlap, if it is a rectangle itself."""
    union = Rectangle(
        min(block.min_x, piece.min_x),
        min(block.min_y, piece.min_y),
        max(block.max_x, piece.max_x),
        max(block.max_y, piece.max_y),
    )
    return union if abs(union.area - block.area - piece.area) < CLOSE_M else None


WALL_M = 0.1  # thickness of every wall


class WallSide(Enum):
    """A side of a rectangle of floor; the value is the outward normal."""

    EAST = (1.0, 0.0)
    WEST = (-1.0, 0.0)
    NORTH = (0.0, 1.0)
    SOUTH = (0.0, -1.0)

    @property
    def inward_rad(self) -> float:
        """Heading from the wall into the room [rad]."""
        return math.atan2(-self.value[1], -self.value[0])

    def strip(self, area: Rectangle, depth_m: float) -> Rectangle:
        """Return the strip of a depth outside this side; north and south strips include the corners."""
        if self is WallSide.EAST:
            return Rectangle(area.max_x, area.min_y, area.max_x + depth_m, area.max_y)
        if self is WallSide.WEST:
            return Rectangle(area.min_x - depth_m, area.min_y, area.min_x, area.max_y)
        left, right = area.min_x - depth_m, area.max_x + depth_m
        if self is WallSide.NORTH:
            return Rectangle(left, area.max_y, right, area.max_y + depth_m)
        return Rectangle(left, area.min_y - depth_m, right, area.min_y)

    def at(self, area: Rectangle, along_m: float) -> tuple[float, float]:
        """Return the point (x, y) [m] of this side of an area at a world coordinate along it."""
        if self is WallSide.EAST:
            return area.max_x, along_m
        if self is WallSide.WEST:
            return area.min_x, along_m
        return along_m, area.max_y if self is WallSide.NORTH else area.min_y

    def span(self, area: Rectangle) -> tuple[float, float]:
        """Return the smallest and largest world coordinate along this side of an area."""
        if self in (WallSide.EAST, WallSide.WEST):
            return area.min_y, area.max_y
        return area.min_x, area.max_x


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """One side of an area, with a wall where no other area adjoins."""

    name: str
    area: Rectangle
    side: WallSide


@dataclass(frozen=True, slots=True, kw_only=True)
class Door:
    """A door in a wall. An open door leads to a small lobby, in which people wait out of sight."""

    wall: Annotated[
        Word,
        Field(
            description="wall of the door: `north`, `south`, `east` or `west`; in L and T corridors, "
            "these names follow that of the leg, as in `first_north`"
        ),
    ]
    along_m: Annotated[
        Coordinate,
        Field(
            description="centre of the door: world x in a north or south wall, world y in an east or "
            "west wall"
        ),
    ]
    width_m: Annotated[float, Field(ge=0.7, le=4.0, description="width of the opening")] = 0.95
    height_m: Annotated[float, Field(ge=1.9, le=3.0, description="height of the opening")] = 2.05
    is_open: Annotated[
        bool,
        Field(
            alias="open",
            description="whether the door is open; a closed door is a leaf on the "
            "wall, with no lobby behind it",
        ),
    ] = True
    lobby_m: Annotated[float, Field(ge=1.0, le=6.0, description="depth of the lobby behind an open door")] = (
        1.5
    )


LOBBY_MARGIN_M = 0.9  # space beside the opening, enough to stand out of sight


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """The rectangles of a place, in metres, with its doors.

    Attributes:
        areas: name and rectangle of each room or leg of a corridor; they touch or overlap.
        doors: in the walls around them.
    """

    areas: tuple[tuple[str, Rectangle], ...]
    doors: tuple[Door, ...] = ()

    def __post_init__(self) -> None:
        """Check that doors fit into their walls, and that their lobbies do not overlap the place.

        Raises:
            BadInput: a door is wider than its wall, overlaps another one, or has no space behind it.
        """
        for index, door in enumerate(self.doors):
            self._check_fits(index, door)
            for other_index, other in enumerate(self.doors[:index]):
                if self.opening(door).grown(WALL_M).meets(self.opening(other)):
                    raise BadInput(
                        f"overlaps doors[{other_index}] in wall {door.wall!r}", key=("doors", index)
                    )

    def wall(self, name: str) -> Wall:
        """Find a wall.

        Raises:
            BadInput: the wall is unknown.
        """
        found = {wall.name: wall for wall in self.walls()}
        if name not in found:
            raise BadInput(f"unknown wall {name!r}; the walls are {', '.join(found)}")
        return found[name]

    def walls(self) -> tuple[Wall, ...]:
        """List the sides of all areas that have at least one piece of wall."""
        return _walls(self.areas)

    def opening(self, door: Door) -> Rectangle:
        """Return the floor inside the thickness of the wall, from jamb to jamb."""
        return self._behind(door, 0.0, WALL_M, door.width_m / 2.0)

    def lobby(self, door: Door) -> Rectangle:
        """Return the floor of the lobby behind an open door."""
        return self._behind(door, WALL_M, WALL_M + door.lobby_m, door.width_m / 2.0 + LOBBY_MARGIN_M)

    def walkable(self) -> tuple[Rectangle, ...]:
        """All rectangles of floor: areas, then the openings and lobbies of open doors."""
        open_doors = [door for door in self.doors if door.is_open]
        return (
            *(area for _, area in self.areas),
            *(self.opening(door) for door in open_doors),
            *(self.lobby(door) for door in open_doors),
        )

    def wall_pieces(self) -> tuple[tuple[Wall, Rectangle], ...]:
        """Divide all walls into upright blocks that overlap neither each other nor the floor."""
        floor = self.walkable()
        placed: list[tuple[Wall, Rectangle]] = []
        for wall in (*self.walls(), *self._lobby_walls()):
            taken = (*floor, *(block for _, block in placed))
            placed += [(wall, block) for block in subtract(wall.side.strip(wall.area, WALL_M), taken)]
        return _join_stubs(placed)

    def contains(self, x: float, y: float) -> bool:
        """Whether a point is on the floor, lobbies of open doors included."""
        return any(area.contains(x, y) for area in self.walkable())

    def describe(self) -> str:
        """Return a description of the floor, for messages."""
        parts = (
            f"{f'{name} has ' if name else ''}x {a.min_x:g} to {a.max_x:g} and y {a.min_y:g} to {a.max_y:g}"
            for name, a in self.areas
        )
        return f"the floor: {', '.join(parts)}"

    def bounds(self) -> Rectangle:
        """The rectangle around all floor and walls."""
        floor = self.walkable()
        return Rectangle(
            min(area.min_x for area in floor),
            min(area.min_y for area in floor),
            max(area.max_x for area in floor),
            max(area.max_y for area in floor),
        ).grown(WALL_M)

    def _check_fits(self, index: int, door: Door) -> None:
        wall = self.wall(door.wall)
        low, high = wall.side.span(wall.area)
        half = door.width_m / 2.0 + WALL_M
        if not low + half <= door.along_m <= high - half:
            raise BadInput(
                f"{door.along_m:g} does not leave space for a door of {door.width_m:g} m "
                f"in wall {door.wall!r}, which reaches from {low:g} to {high:g} m",
                key=("doors", index, "along_m"),
            )
        behind = (
            (self.lobby(door).grown(WALL_M), self.opening(door)) if door.is_open else (self.opening(door),)
        )
        for name, area in self.areas:
            if any(part.meets(area) for part in behind):
                raise BadInput(
                    f"{door.along_m:g}: behind the door of wall {door.wall!r} is {name or 'the room'}; "
                    f"choose a position with {WALL_M + door.lobby_m:g} m of space behind the wall",
                    key=("doors", index, "along_m"),
                )

    def _lobby_walls(self) -> tuple[Wall, ...]:
        return tuple(
            Wall(name=f"door_{number}_lobby", area=self.lobby(door), side=side)
            for number, door in enumerate(self.doors, start=1)
            if door.is_open
            for side in WallSide
        )

    def _behind(self, door: Door, near_m: float, far_m: float, half_m: float) -> Rectangle:
        """Return the rectangle from near_m to far_m behind a door's wall, half_m to either side."""
        wall = self.wall(door.wall)
        x, y = wall.side.at(wall.area, door.along_m)
        nx, ny = wall.side.value
        corners_x = sorted((x + nx * near_m - abs(ny) * half_m, x + nx * far_m + abs(ny) * half_m))
        corners_y = sorted((y + ny * near_m - abs(nx) * half_m, y + ny * far_m + abs(nx) * half_m))
        return Rectangle(corners_x[0], corners_y[0], corners_x[1], corners_y[1])


@lru_cache(maxsize=64)
def _walls(areas: tuple[tuple[str, Rectangle], ...]) -> tuple[Wall, ...]:
    inside = tuple(area for _, area in areas)
    named = (
        Wall(name=f"{name}_{side.name.lower()}" if name else side.name.lower(), area=area, side=side)
        for name, area in areas
        for side in (WallSide.NORTH, WallSide.SOUTH, WallSide.EAST, WallSide.WEST)
    )
    return tuple(wall for wall in named if subtract(_facing(wall), inside))


def _join_stubs(blocks: list[tuple[Wall, Rectangle]]) -> tuple[tuple[Wall, Rectangle], ...]:
    """Join each single corner to a block that it lengthens, so that no seam crosses a straight wall."""
    joined = list(blocks)
    for stub in [item for item in blocks if item[1].longer_side <= WALL_M + CLOSE_M]:
        if stub not in joined:
            continue  # lengthened by another corner
        others = [item for item in joined if item != stub]
        for index, (wall, block) in enumerate(others):
            union = lengthened(block, stub[1])
            if union is not None:
                others[index] = (wall, union)
                joined = others
                break
    return tuple(joined)


def _facing(wall: Wall) -> Rectangle:
    """Return the strip outside a wall's area, without its corners."""
    strip = wall.side.strip(wall.area, WALL_M)
    if wall.side in (WallSide.NORTH, WallSide.SOUTH):
        return Rectangle(wall.area.min_x, strip.min_y, wall.area.max_x, strip.max_y)
    return strip
