"""Things that stand or hang in a place, built into fixtures."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from peopleboy.sim.places.furniture.thing_kinds import KINDS, Kind
from peopleboy.sim.places.pieces import Piece
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material, Pattern, Rgb
from peopleboy.sim.shapes.shapes import Part, Vector

_USUAL_AIR_C = 21.0  # for which the kinds' temperatures are given
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
        air_c: [degC] of the air, followed by what is not heated and has no temperature of its own; None
            leaves all as it is in a room of 21 degC.
        emissivity: of its main surface.
        shine: of its main surface, see `Material`; None takes the kind's own.
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
    air_c: float | None = None
    emissivity: float = 0.93
    shine: float | None = None
    rgb: Rgb | None = None
    pattern: Pattern = field(default_factory=Pattern)
    urdf: str | None = None
    scale: float = 1.0


def build_thing(thing: Thing) -> tuple[Fixture, ...]:
    """Build a thing as fixtures called "name/piece"; one of a single piece keeps its bare name."""
    position = (*thing.at_m, thing.base_m)
    turned = (0.0, 0.0, math.sin(thing.facing_rad / 2.0), math.cos(thing.facing_rad / 2.0))
    if thing.kind == "urdf":
        temperature = _given(thing.temperature_c, 21.0)
        material = Material(
            temperature_c=temperature, emissivity=thing.emissivity, shine=_given(thing.shine, 0.0)
        )
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
    """The pieces of a thing; emissivity, shine and pattern go to the first, the main one."""
    size = kind.size_m if thing.size_m is None else thing.size_m
    rgb = kind.rgb if thing.rgb is None else thing.rgb
    warmer_k = 0.0 if thing.air_c is None else thing.air_c - _USUAL_AIR_C
    usual_c = kind.temperature_c if kind.is_heated else kind.temperature_c + warmer_k
    main, *others = kind.build(size, _given(thing.temperature_c, usual_c), rgb)
    if kind.is_heated:
        others = [replace(piece, temperature_c=piece.temperature_c + warmer_k) for piece in others]
    shine = _given(thing.shine, main.shine)
    return (replace(main, emissivity=thing.emissivity, shine=shine, pattern=thing.pattern), *others)


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
        shine=piece.shine,
        covering=piece.covering,
        gradient_k_per_m=piece.gradient_k_per_m,
        uneven_k=piece.uneven_k,
    )
