"""Every kind of thing by name, with its usual size, temperature and colour."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from peopleboy.sim.places.furniture import (
    appliances,
    furniture_pieces,
    household_pieces,
    street_pieces,
    warm_pieces,
)
from peopleboy.sim.places.pieces import BLACK, STEEL, WHITE, WOOD, Piece
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
        is_heated: whether its main piece is warm by itself, and not as the air has it.
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
    is_heated: bool = False


KINDS: dict[str, Kind] = {
    "radiator": Kind(
        build=warm_pieces.radiator,
        is_heated=True,
        size_m=(0.09, 1.2, 0.6),
        temperature_c=48.0,
        rgb=WHITE,
        base_m=0.12,
        is_hung=True,
    ),
    "pipe": Kind(
        build=warm_pieces.pipe,
        is_heated=True,
        size_m=(0.06, 0.06, 2.7),
        temperature_c=44.0,
        rgb=WHITE,
        is_hung=True,
        is_to_ceiling=True,
    ),
    "ceiling_lamp": Kind(
        build=warm_pieces.ceiling_lamp,
        is_heated=True,
        size_m=(0.22, 1.25, 0.1),
        temperature_c=62.0,
        rgb=(1.0, 1.0, 0.95),
        is_from_ceiling=True,
    ),
    "floor_lamp": Kind(
        build=warm_pieces.floor_lamp,
        size_m=(0.36, 0.36, 1.6),
        temperature_c=75.0,
        rgb=(1.0, 0.95, 0.8),
        is_heated=True,
    ),
    "monitor": Kind(
        build=warm_pieces.monitor,
        size_m=(0.2, 0.55, 0.46),
        temperature_c=35.0,
        rgb=(0.35, 0.5, 0.75),
        is_heated=True,
    ),
    "robot": Kind(
        build=warm_pieces.robot,
        size_m=(0.47, 0.38, 1.12),
        temperature_c=27.0,
        rgb=(0.5, 0.04, 0.05),
        is_heated=True,
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
    "light_panel": Kind(
        build=appliances.lit_shade,
        size_m=(0.6, 0.6, 0.04),
        temperature_c=31.0,
        rgb=(1.0, 1.0, 0.97),
        is_from_ceiling=True,
        is_heated=True,
    ),
    "screen": Kind(
        build=appliances.screen,
        size_m=(0.06, 1.25, 0.72),
        temperature_c=33.0,
        rgb=(0.3, 0.45, 0.7),
        base_m=1.2,
        is_hung=True,
        is_heated=True,
    ),
    "kettle": Kind(
        build=appliances.kettle, size_m=(0.25, 0.18, 0.26), temperature_c=70.0, rgb=STEEL, is_heated=True
    ),
    "fridge": Kind(build=appliances.fridge, size_m=(0.62, 0.6, 1.8), temperature_c=20.0, rgb=WHITE),
    "oven": Kind(
        build=appliances.oven, size_m=(0.6, 0.6, 0.9), temperature_c=46.0, rgb=WHITE, is_heated=True
    ),
    "counter": Kind(build=appliances.counter, size_m=(0.6, 2.4, 0.9), temperature_c=21.2, rgb=WHITE),
    "shelf": Kind(
        build=appliances.shelf_of_boxes, size_m=(0.45, 1.2, 1.9), temperature_c=21.5, rgb=(0.45, 0.33, 0.2)
    ),
    "vending_machine": Kind(
        build=appliances.vending_machine, size_m=(0.8, 0.95, 1.85), temperature_c=24.5, rgb=(0.5, 0.05, 0.06)
    ),
    "machine": Kind(
        build=appliances.machine,
        size_m=(0.9, 2.0, 1.35),
        temperature_c=44.0,
        rgb=(0.12, 0.25, 0.2),
        is_heated=True,
    ),
    "glass_wall": Kind(
        build=appliances.glass_wall, size_m=(0.08, 2.4, 2.4), temperature_c=19.5, rgb=(0.45, 0.55, 0.55)
    ),
    "dog": Kind(
        build=appliances.dog,
        size_m=(0.75, 0.28, 0.6),
        temperature_c=28.5,
        rgb=(0.3, 0.18, 0.08),
        is_heated=True,
    ),
    "bench": Kind(
        build=appliances.bench, size_m=(0.55, 1.6, 0.85), temperature_c=21.0, rgb=WOOD, is_seat=True
    ),
    "railing": Kind(build=appliances.railing, size_m=(0.04, 2.0, 1.05), temperature_c=19.5, rgb=STEEL),
    "car": Kind(
        build=street_pieces.car,
        size_m=(4.2, 1.75, 1.45),
        temperature_c=36.0,
        rgb=(0.08, 0.12, 0.3),
        is_heated=True,
    ),
    "bicycle": Kind(
        build=street_pieces.bicycle, size_m=(1.75, 0.55, 1.05), temperature_c=20.0, rgb=(0.05, 0.25, 0.12)
    ),
    "tree": Kind(build=street_pieces.tree, size_m=(3.2, 3.2, 5.5), temperature_c=21.0, rgb=(0.06, 0.2, 0.05)),
    "street_lamp": Kind(
        build=street_pieces.street_lamp,
        size_m=(0.45, 0.45, 4.2),
        temperature_c=33.0,
        rgb=(0.08, 0.1, 0.09),
        is_heated=True,
    ),
    "market_stall": Kind(
        build=street_pieces.market_stall,
        size_m=(1.6, 2.6, 2.5),
        temperature_c=62.0,
        rgb=(0.55, 0.1, 0.08),
        is_heated=True,
    ),
    "bin": Kind(build=street_pieces.bin_, size_m=(0.5, 0.5, 0.95), temperature_c=20.5, rgb=BLACK),
}
