"""Pieces of things: shapes of one temperature and colour, in the frame of the thing.

A thing's frame: x forward, y left, z up; origin on the floor below its middle, or on the wall behind it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from peopleboy.sim.shapes.materials import Covering, Pattern, Rgb
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, ShapeKind, Vector

# Feet extend this far into the floor and backs into the wall, so that no two faces are coplanar.
SINK_M = 0.01

WHITE: Rgb = (0.78, 0.78, 0.75)
BLACK: Rgb = (0.03, 0.03, 0.035)
STEEL: Rgb = (0.45, 0.46, 0.48)
WOOD: Rgb = (0.40, 0.26, 0.14)
ALONG_Y: Quaternion = (math.sin(math.pi / 4.0), 0.0, 0.0, math.cos(math.pi / 4.0))


@dataclass(frozen=True, slots=True)
class Piece:
    """Shapes of one appearance in the frame of their thing; see `Material` for the other attributes."""

    name: str
    shapes: tuple[Shape, ...]
    temperature_c: float
    rgb: Rgb
    emissivity: float = 0.93
    glow: float = 0.0
    variation_k: float = 0.2
    pattern: Pattern = field(default_factory=Pattern)
    is_solid: bool = True
    shine: float = 0.0
    covering: Covering = Covering.BARE
    gradient_k_per_m: float = 0.0
    uneven_k: float = 0.0
    is_clear: bool = False


Builder = Callable[[Vector, float, Rgb], tuple[Piece, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """A kind of thing, with its usual size (depth, width, height), temperature and colour.

    Attributes:
        build: maps size [m], main temperature [degC] and colour to pieces, the main one first.
        is_hung: whether it is mounted on a wall.
        is_from_ceiling: whether it hangs from the ceiling.
        is_to_ceiling: whether its usual height is that of the place.
        is_seat: whether a person can sit on it, and so may overlap it.
        base_m: [m] usual height of its foot.
        is_heated: whether its main piece is heated, and does not follow the air.
    """

    build: Builder
    size_m: Vector
    temperature_c: float
    rgb: Rgb
    base_m: float = 0.0
    is_hung: bool = False
    is_from_ceiling: bool = False
    is_to_ceiling: bool = False
    is_seat: bool = False
    is_heated: bool = False


_KINDS_BY_MODULE: dict[str, dict[str, Kind]] = {}


def thing_kind(name: str, **usual: Any) -> Callable[[Builder], Builder]:
    """Register a builder as a kind of thing, with the attributes of `Kind`.

    If a builder has several kinds, the lowest decorator is registered first.
    """

    def register(build: Builder) -> Builder:
        _KINDS_BY_MODULE.setdefault(build.__module__, {})[name] = Kind(build=build, **usual)
        return build

    return register


def kinds_of(module: str) -> dict[str, Kind]:
    """Return the kinds that the builders of a module register, in the order of their definition."""
    return _KINDS_BY_MODULE[module]


def box(size: Vector, position: Vector) -> Shape:
    """Make a box from its full extents and its centre [m]."""
    return Shape(kind=ShapeKind.BOX, size=size, position=position)


def standing_box(
    depth: float, width: float, bottom: float, top: float, x: float = 0.0, y: float = 0.0
) -> Shape:
    """Make a box from one height to another [m]."""
    return box((depth, width, top - bottom), (x, y, (bottom + top) / 2.0))


def tube(length: float, radius: float, position: Vector, orientation: Quaternion = UPRIGHT) -> Shape:
    """Make a cylinder from its length, radius and centre [m], along z unless turned."""
    return Shape(
        kind=ShapeKind.CYLINDER, size=(length, radius, 0.0), position=position, orientation=orientation
    )


def ball(radius: float, position: Vector) -> Shape:
    """Make a sphere [m]."""
    return Shape(kind=ShapeKind.SPHERE, size=(radius, 0.0, 0.0), position=position)


def corner_legs(thick: float, top: float, x: float, y: float) -> tuple[Shape, ...]:
    """Make four square legs from below the floor to a height, at a distance [m] from the centre."""
    return tuple(
        standing_box(thick, thick, -SINK_M, top, x=sx * x, y=sy * y)
        for sx in (-1.0, 1.0)
        for sy in (-1.0, 1.0)
    )
