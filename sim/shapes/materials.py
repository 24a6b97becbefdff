"""How surfaces look to the thermal and the colour camera."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal

from peopleboy.sim.shapes.finishes import Finish

Detail = Literal["plain", "full"]
Rgb = tuple[float, float, float]


class PatternKind(IntEnum):
    """Two-valued patterns that a surface may carry, in the frame of its part."""

    PLAIN = 0
    STRIPES = 1  # horizontal bands across the part's z axis
    CHECKS = 2  # cubes of two colours, a chessboard on each flat side
    PATCH = 3  # an upright ellipse on the side that faces +x, like a print on a chest
    SPECKLE = 4  # irregular blotches


class Covering(IntEnum):
    """What covers a surface, which `detail: full` paints."""

    BARE = 0
    PLASTER = 1  # inner walls
    FLOORING = 2
    CEILING = 3
    STREET = 4  # pavement and road
    FACADE = 5  # storeys of windows
    SKY = 6
    SKYLINE = 7  # far houses and trees before the sky
    LEAVES = 8
    GLASS = 9  # lets the sun in


@dataclass(frozen=True, slots=True, kw_only=True)
class Pattern:
    """A pattern and its period: the width of a pair of stripes, or the height of a patch [m]."""

    kind: PatternKind = PatternKind.PLAIN
    period_m: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """One surface, as both cameras need it.

    Attributes:
        temperature_c: [degC] mean surface temperature.
        emissivity: share of black-body radiance that the surface emits; the rest mirrors the surroundings.
        variation_k: [K] amplitude of the smooth variation of temperature over the surface.
        variation_m: [m] wavelength of that variation.
        contrast_k: [K] temperature of the pattern's second value above the first.
        thermal_pattern: where the second temperature applies.
        rgb: linear reflectance 0..1 of the first colour.
        second_rgb: linear reflectance of the pattern's second colour.
        colour_pattern: where the second colour applies.
        glow: share of light that the surface gives out itself (a lamp or a monitor), whatever the room's
            light; 0 for everything else.
        finish: what the surface carries beside; None for nothing.
        shine: how much of what the surface reflects it mirrors as a mirror does, 0..1: 0 is dull, 1 is glass.
            Only images of full detail show it.
        covering: what `detail: full` paints on it.
        gradient_k_per_m: [K/m] how much warmer it is above than below, by `detail: full`.
        uneven_k: [K] deviation of its temperature over all scales, by `detail: full`.
    """

    temperature_c: float
    emissivity: float = 0.95
    variation_k: float = 0.0
    variation_m: float = 0.25
    contrast_k: float = 0.0
    thermal_pattern: Pattern = field(default_factory=Pattern)
    rgb: Rgb = (0.5, 0.5, 0.5)
    second_rgb: Rgb = (0.5, 0.5, 0.5)
    colour_pattern: Pattern = field(default_factory=Pattern)
    glow: float = 0.0
    finish: Finish | None = None
    shine: float = 0.0
    covering: Covering = Covering.BARE
    gradient_k_per_m: float = 0.0
    uneven_k: float = 0.0
