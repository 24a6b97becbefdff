"""Pieces of things: shapes of one temperature and colour, in the frame of the thing.

A thing's frame: x forward, y left, z up; origin on the floor below its middle, or on the wall behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from peopleboy.sim.shapes.materials import Covering, Pattern, Rgb
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, ShapeKind, Vector

# Feet reach this far into the floor and backs into the wall, so that no two faces lie in one plane.
SINK_M = 0.01

WHITE: Rgb = (0.78, 0.78, 0.75)
BLACK: Rgb = (0.03, 0.03, 0.035)
STEEL: Rgb = (0.45, 0.46, 0.48)
WOOD: Rgb = (0.40, 0.26, 0.14)
ALONG_Y: Quaternion = (math.sin(math.pi / 4.0), 0.0, 0.0, math.cos(math.pi / 4.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """Shapes of one look in the frame of their thing; see `Material` for what the rest means."""

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


def box(size: Vector, position: Vector) -> Shape:
    """A box by its full extents and its middle [m]."""
    return Shape(kind=ShapeKind.BOX, size=size, position=position)


def standing_box(
    depth: float, width: float, bottom: float, top: float, x: float = 0.0, y: float = 0.0
) -> Shape:
    """A box from one height to another [m]."""
    return box((depth, width, top - bottom), (x, y, (bottom + top) / 2.0))


def tube(length: float, radius: float, position: Vector, orientation: Quaternion = UPRIGHT) -> Shape:
    """A cylinder by its length, radius and middle [m]; along z unless turned."""
    return Shape(
        kind=ShapeKind.CYLINDER, size=(length, radius, 0.0), position=position, orientation=orientation
    )


def ball(radius: float, position: Vector) -> Shape:
    """A sphere [m]."""
    return Shape(kind=ShapeKind.SPHERE, size=(radius, 0.0, 0.0), position=position)
