"""Things that stand or hang in a place: every kind by name, built into fixtures."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from peopleboy.sim.places import furniture, warm_things
from peopleboy.sim.places.pieces import WHITE, WOOD, Piece
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material, Pattern, Rgb
from peopleboy.sim.shapes.shapes import Part, Vector

_SHADE = 0.45  # brightness of a pattern's second colour, as a share of the first


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """What to build and where.

    Attributes:
        name: unique in its place.
        kind: a key of `KINDS`, or "urdf".
        at_m: (x, y) [m] world frame.
        base_m: [m] height of its foot.
        facing_rad: [rad] heading of its front.
        size_m: depth, width, height [m]; None takes the kind's own.
        temperature_c: [degC] of its main surface; None takes the kind's own.
        emissivity: of its main surface.
        rgb: linear reflectance of its main surface; None takes the kind's own, a URDF its file's.
        pattern: of its main surface's colour.
        urdf, scale: the file of a "urdf", and its size.
    """

    name: str
    kind: str
    at_m: tuple[float, float]
    base_m: float = 0.0
    facing_rad: float = 0.0
    size_m: Vector | None = None
    temperature_c: float | None = None
    emissivity: float = 0.93
    rgb: Rgb | None = None
    pattern: Pattern = field(default_factory=Pattern)
    urdf: str | None = None
    scale: float = 1.0


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


def build_thing(thing: Thing) -> tuple[Fixture, ...]:
    """Build a thing as fixtures called "name/piece"; one of a single piece keeps its bare name."""
    position = (*thing.at_m, thing.base_m)
    turned = (0.0, 0.0, math.sin(thing.facing_rad / 2.0), math.cos(thing.facing_rad / 2.0))
    if thing.kind == "urdf":
        temperature = _given(thing.temperature_c, 21.0)
        material = Material(temperature_c=temperature, emissivity=thing.emissivity)
        return (
            Fixture(
                name=thing.name,
                urdf=thing.urdf,
                material=material,
                scale=thing.scale,
                position=position,
                orientation=turned,
            ),
        )
    pieces = _pieces(thing, KINDS[thing.kind])
    return tuple(
        Fixture(
            name=f"{thing.name}/{piece.name}" if len(pieces) > 1 else thing.name,
            part=Part(name=piece.name, shapes=piece.shapes, material=_material(piece)),
            position=position,
            orientation=turned,
            is_solid=piece.is_solid,
        )
        for piece in pieces
    )


def _pieces(thing: Thing, kind: Kind) -> tuple[Piece, ...]:
    """The pieces of a thing; emissivity and pattern go to the first, the main one."""
    size = kind.size_m if thing.size_m is None else thing.size_m
    rgb = kind.rgb if thing.rgb is None else thing.rgb
    main, *others = kind.build(size, _given(thing.temperature_c, kind.temperature_c), rgb)
    return (replace(main, emissivity=thing.emissivity, pattern=thing.pattern), *others)


def _given(value: float | None, default: float) -> float:
    return default if value is None else value


def _material(piece: Piece) -> Material:
    red, green, blue = (_SHADE * part for part in piece.rgb)
    return Material(
        temperature_c=piece.temperature_c,
        emissivity=piece.emissivity,
        variation_k=piece.variation_k,
        variation_m=0.5,
        rgb=piece.rgb,
        second_rgb=(red, green, blue),
        colour_pattern=piece.pattern,
        glow=piece.glow,
    )


KINDS: dict[str, Kind] = {
    "radiator": Kind(
        build=warm_things.radiator,
        size_m=(0.09, 1.2, 0.6),
        temperature_c=48.0,
        rgb=WHITE,
        base_m=0.12,
        is_hung=True,
    ),
    "pipe": Kind(
        build=warm_things.pipe,
        size_m=(0.06, 0.06, 2.7),
        temperature_c=44.0,
        rgb=WHITE,
        is_hung=True,
        is_to_ceiling=True,
    ),
    "ceiling_lamp": Kind(
        build=warm_things.ceiling_lamp,
        size_m=(0.22, 1.25, 0.1),
        temperature_c=62.0,
        rgb=(1.0, 1.0, 0.95),
        is_from_ceiling=True,
    ),
    "floor_lamp": Kind(
        build=warm_things.floor_lamp, size_m=(0.36, 0.36, 1.6), temperature_c=75.0, rgb=(1.0, 0.95, 0.8)
    ),
    "monitor": Kind(
        build=warm_things.monitor, size_m=(0.2, 0.55, 0.46), temperature_c=35.0, rgb=(0.35, 0.5, 0.75)
    ),
    "robot": Kind(
        build=warm_things.robot, size_m=(0.47, 0.38, 1.12), temperature_c=27.0, rgb=(0.5, 0.04, 0.05)
    ),
    "window": Kind(
        build=furniture.window,
        size_m=(0.05, 1.4, 1.2),
        temperature_c=16.0,
        rgb=(0.55, 0.65, 0.75),
        base_m=0.95,
        is_hung=True,
    ),
    "poster": Kind(
        build=furniture.poster,
        size_m=(0.01, 0.6, 0.9),
        temperature_c=21.5,
        rgb=(0.7, 0.2, 0.15),
        base_m=1.0,
        is_hung=True,
    ),
    "table": Kind(build=furniture.table, size_m=(0.75, 1.4, 0.74), temperature_c=21.5, rgb=WOOD),
    "chair": Kind(
        build=furniture.chair,
        size_m=(0.45, 0.45, 0.9),
        temperature_c=21.8,
        rgb=(0.08, 0.1, 0.25),
        is_seat=True,
    ),
    "cabinet": Kind(
        build=furniture.block, size_m=(0.42, 0.8, 1.9), temperature_c=21.3, rgb=(0.5, 0.42, 0.32)
    ),
    "block": Kind(build=furniture.block, size_m=(0.5, 0.5, 0.5), temperature_c=21.5, rgb=(0.5, 0.5, 0.5)),
    "pillar": Kind(
        build=furniture.block,
        size_m=(0.4, 0.4, 2.7),
        temperature_c=21.5,
        rgb=(0.6, 0.58, 0.54),
        is_to_ceiling=True,
    ),
    "round_pillar": Kind(
        build=furniture.column,
        size_m=(0.4, 0.4, 2.7),
        temperature_c=21.5,
        rgb=(0.6, 0.58, 0.54),
        is_to_ceiling=True,
    ),
    "plant": Kind(build=furniture.plant, size_m=(0.6, 0.6, 1.4), temperature_c=20.5, rgb=(0.05, 0.22, 0.06)),
}
