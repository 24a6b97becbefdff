"""Things that stand or hang in a place, built into fixtures."""

from __future__ import annotations

from dataclasses import replace

from peopleboy.sim.places.furniture.thing_config import KINDS, ThingConfig
from peopleboy.sim.places.moving import Stance
from peopleboy.sim.places.pieces import Kind, Piece
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material, Pattern, PatternKind, rgb_of
from peopleboy.sim.shapes.shapes import Part, Vector

_USUAL_AIR_C = 21.0  # for which the kinds' temperatures are given
_SHADE = 0.45  # brightness of a pattern's second colour, as a share of the first


def build_thing(
    config: ThingConfig,
    stance: Stance,
    *,
    name: str | None = None,
    size_m: Vector | None = None,
    air_c: float | None = None,
    urdf: str | None = None,
) -> tuple[Fixture, ...]:
    """Build a thing as fixtures called "name/piece"; one of a single piece keeps its bare name.

    Args:
        config: what it is, and how its main surface looks.
        stance: where it stands.
        name: unique in its place; None for the name in the settings.
        size_m: [m] depth, width, height; None for the kind's usual size.
        air_c: [degC] air of the place, which things that are not heated follow; None for the usual air.
        urdf: file of a thing of kind "urdf", as PyBullet finds it.
    """
    name = config.name or config.kind if name is None else name
    if config.kind == "urdf":
        material = Material(
            temperature_c=_given(config.temperature_c, _USUAL_AIR_C),
            emissivity=config.emissivity,
            shine=_given(config.shine, 0.0),
        )
        return (
            Fixture(
                name=name,
                urdf=urdf,
                material=material,
                scale=config.scale,
                position=stance.position_m,
                orientation=stance.orientation,
            ),
        )
    pieces = _pieces(config, KINDS[config.kind], size_m, air_c)
    return tuple(
        Fixture(
            name=f"{name}/{piece.name}" if len(pieces) > 1 else name,
            part=Part(name=piece.name, shapes=piece.shapes, material=_material(piece)),
            position=stance.position_m,
            orientation=stance.orientation,
            is_solid=piece.is_solid,
        )
        for piece in pieces
    )


def _pieces(config: ThingConfig, kind: Kind, size_m: Vector | None, air_c: float | None) -> tuple[Piece, ...]:
    """The pieces of a thing; emissivity, shine and pattern go to the first, the main one."""
    rgb = kind.rgb if config.colour is None else rgb_of(config.colour)
    warmer_k = 0.0 if air_c is None else air_c - _USUAL_AIR_C
    usual_c = kind.temperature_c if kind.is_heated else kind.temperature_c + warmer_k
    size = kind.size_m if size_m is None else size_m
    main, *others = kind.build(size, _given(config.temperature_c, usual_c), rgb)
    if kind.is_heated:
        others = [replace(piece, temperature_c=piece.temperature_c + warmer_k) for piece in others]
    pattern = Pattern(kind=PatternKind[config.pattern.kind.upper()], period_m=config.pattern.period_m)
    shine = _given(config.shine, main.shine)
    return (replace(main, emissivity=config.emissivity, shine=shine, pattern=pattern), *others)


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
