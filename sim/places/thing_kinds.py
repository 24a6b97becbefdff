"""Every kind of thing by name, with its usual size, temperature and colour."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from peopleboy.sim.places import furniture_pieces, household_pieces, warm_pieces
from peopleboy.sim.places.pieces import WHITE, WOOD, Piece
from peopleboy.sim.shapes.materials import Rgb
from peopleboy.sim.shapes.shapes import Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """A kind of thing, with its usual size (depth, width, height), temperature and colour.

    Attributes:
        build: size [m] and main temperature [degC] and colour to pieces, the main one first.
        is_hung: whether it hangs on a wall, its back against it.
        is_from_ceiling: whether it hangs under the ceiling.
        is_to_ceiling: whether its usual height is that of the place.
        is_seat: whether a person may sit on it, and so be where it is.
        base_m: [m] usual height of its foot.
    """

    build: Callable[[Vector, float, Rgb], tuple[Piece, ...]]
    size_m: Vector
    temperature_c: float
    rgb: Rgb
    base_m: float = 0.0
    is_hung: bool = False
    is_from_ceiling: bool = False
    is_to_ceiling: bool = False
    is_seat: bool = False


KINDS: dict[str, Kind] = {
    "radiator": Kind(
        build=warm_pieces.radiator,
        size_m=(0.09, 1.2, 0.6),
        temperature_c=48.0,
        rgb=WHITE,
        base_m=0.12,
        is_hung=True,
    ),
    "pipe": Kind(
        build=warm_pieces.pipe,
        size_m=(0.06, 0.06, 2.7),
        temperature_c=44.0,
        rgb=WHITE,
        is_hung=True,
        is_to_ceiling=True,
    ),
    "ceiling_lamp": Kind(
        build=warm_pieces.ceiling_lamp,
        size_m=(0.22, 1.25, 0.1),
        temperature_c=62.0,
        rgb=(1.0, 1.0, 0.95),
        is_from_ceiling=True,
    ),
    "floor_lamp": Kind(
        build=warm_pieces.floor_lamp, size_m=(0.36, 0.36, 1.6), temperature_c=75.0, rgb=(1.0, 0.95, 0.8)
    ),
    "monitor": Kind(
        build=warm_pieces.monitor, size_m=(0.2, 0.55, 0.46), temperature_c=35.0, rgb=(0.35, 0.5, 0.75)
    ),
    "robot": Kind(
        build=warm_pieces.robot, size_m=(0.47, 0.38, 1.12), temperature_c=27.0, rgb=(0.5, 0.04, 0.05)
    ),
    "window": Kind(
        build=furniture_pieces.window,
        size_m=(0.05, 1.4, 1.2),
        temperature_c=16.0,
        rgb=(0.55, 0.65, 0.75),
        base_m=0.95,
        is_hung=True,
    ),
    "poster": Kind(
        build=furniture_pieces.poster,
        size_m=(0.01, 0.6, 0.9),
        temperature_c=21.5,
        rgb=(0.7, 0.2, 0.15),
        base_m=1.0,
        is_hung=True,
    ),
    "table": Kind(build=furniture_pieces.table, size_m=(0.75, 1.4, 0.74), temperature_c=21.5, rgb=WOOD),
    "chair": Kind(
        build=furniture_pieces.chair,
        size_m=(0.45, 0.45, 0.9),
        temperature_c=21.8,
        rgb=(0.08, 0.1, 0.25),
        is_seat=True,
    ),
    "cabinet": Kind(
        build=furniture_pieces.block, size_m=(0.42, 0.8, 1.9), temperature_c=21.3, rgb=(0.5, 0.42, 0.32)
    ),
    "block": Kind(
        build=furniture_pieces.block, size_m=(0.5, 0.5, 0.5), temperature_c=21.5, rgb=(0.5, 0.5, 0.5)
    ),
    "pillar": Kind(
        build=furniture_pieces.block,
        size_m=(0.4, 0.4, 2.7),
        temperature_c=21.5,
        rgb=(0.6, 0.58, 0.54),
        is_to_ceiling=True,
    ),
    "round_pillar": Kind(
        build=furniture_pieces.column,
        size_m=(0.4, 0.4, 2.7),
        temperature_c=21.5,
        rgb=(0.6, 0.58, 0.54),
        is_to_ceiling=True,
    ),
    "plant": Kind(
        build=furniture_pieces.plant, size_m=(0.6, 0.6, 1.4), temperature_c=20.5, rgb=(0.05, 0.22, 0.06)
    ),
    "bear": Kind(
        build=household_pieces.bear, size_m=(0.42, 0.42, 0.5), temperature_c=21.5, rgb=(0.32, 0.17, 0.07)
    ),
    "can": Kind(
        build=household_pieces.can, size_m=(0.6, 0.26, 0.4), temperature_c=20.5, rgb=(0.05, 0.18, 0.35)
    ),
    "flower": Kind(
        build=household_pieces.flower, size_m=(0.5, 0.5, 1.0), temperature_c=20.5, rgb=(0.05, 0.22, 0.06)
    ),
    "door_leaf": Kind(
        build=household_pieces.door_leaf, size_m=(0.04, 0.93, 2.03), temperature_c=21.0, rgb=(0.45, 0.3, 0.16)
    ),
    "cupboard": Kind(
        build=household_pieces.cupboard, size_m=(0.45, 0.9, 1.8), temperature_c=21.2, rgb=(0.55, 0.45, 0.33)
    ),
    "drawer": Kind(
        build=household_pieces.drawer, size_m=(0.42, 0.8, 0.2), temperature_c=21.2, rgb=(0.6, 0.5, 0.38)
    ),
}
