"""Materials of surfaces for thermal and colour cameras, and named colours."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from peopleboy.settings import Share, word_or_list

# Details of a surface in addition to its material, such as folds or a face, on a grid around its part.

Grid = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Finish:
    """Differences from a part's material by direction from its z axis, and by height along it.

    Column c of C has the direction c / C of a turn from +x towards +y; columns wrap around.

    Attributes:
        lowest_m: [m] z of the first row.
        texel_m: [m] distance of rows; rows go up.
        kelvin: (R, C) [K] added to the temperature.
        light: (R, C) factor on the reflected light.
        cover: (R, C) share 0..1 of the finish's colour instead of the material's.
        rgb: (3,) linear reflectance of that colour.
    """

    lowest_m: float
    texel_m: float
    kelvin: Grid
    light: Grid
    cover: Grid
    rgb: Grid = field(default_factory=lambda: np.zeros(3))

    def texels(self) -> NDArray[np.int16]:
        """Return (R C, 3) kelvin, light and cover, rounded to 1 / 256, so that all machines have the same."""
        layers = np.stack([self.kelvin, self.light, self.cover], axis=-1).reshape(-1, 3)
        return np.clip(np.rint(layers / TEXEL_STEP), -32768, 32767).astype(np.int16)


TEXEL_STEP: Final = 1.0 / 256.0


Detail = Literal["plain", "full"]
Rgb = tuple[float, float, float]


class PatternKind(IntEnum):
    """Two-valued patterns that a surface may carry, in the frame of its part."""

    PLAIN = 0
    STRIPES = 1  # horizontal bands, perpendicular to the part's z axis
    CHECKS = 2  # cubes of two colours, a checkerboard on each flat side
    PATCH = 3  # an upright ellipse on the +x side, like a print on the chest
    SPECKLE = 4  # irregular blotches


class Covering(IntEnum):
    """Covering of a surface, painted with `detail: full`."""

    BARE = 0
    PLASTER = 1  # inner walls
    FLOORING = 2
    CEILING = 3
    STREET = 4  # pavement and road
    FACADE = 5  # storeys of windows
    SKY = 6
    SKYLINE = 7  # distant houses and trees in front of the sky
    LEAVES = 8
    GLASS = 9  # transparent to sunlight


@dataclass(frozen=True, slots=True, kw_only=True)
class Pattern:
    """A pattern and its size: the width of a pair of stripes, or the height of a patch [m]."""

    kind: PatternKind = PatternKind.PLAIN
    period_m: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """Material of one surface, for thermal and colour cameras.

    Attributes:
        temperature_c: [degC] mean surface temperature.
        emissivity: share of black-body radiance that the surface emits; the rest reflects the surroundings.
        variation_k: [K] amplitude of the smooth variation of temperature over the surface.
        variation_m: [m] wavelength of that variation.
        contrast_k: [K] temperature of the pattern's second value minus that of the first.
        thermal_pattern: pattern of the two temperatures.
        rgb: linear reflectance 0..1 of the first colour.
        second_rgb: linear reflectance of the pattern's second colour.
        colour_pattern: pattern of the two colours.
        glow: share of light that the surface emits (a lamp or a monitor), independent of the room's light; 0
            for all other surfaces.
        finish: details of the surface, or None.
        shine: specular share of the reflection, 0 (dull) to 1 (glass); visible with `detail: full` only.
        covering: texture with `detail: full`.
        gradient_k_per_m: [K/m] vertical temperature gradient, positive if warmer above, with `detail: full`.
        uneven_k: [K] standard deviation of the temperature over all scales, with `detail: full`.
        is_clear: whether light passes through, as through glass; only thermal cameras see the surface then.
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
    is_clear: bool = False


# Fine differences of temperature and brightness in addition to a material, on a grid.


class Unrolling(IntEnum):
    """Mapping of a texture to its part: sums of the part's coordinates that are its axes."""

    LEVEL = 0  # across is x, up is y: floors and ceilings
    UPRIGHT = 1  # across is x + y, up is z: walls, and objects on the floor
    ASLANT = 2  # across is x + y, up is z + (x - y) / 2: round objects, so that no side lacks a pattern


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Painting:
    """Differences from a part's material over its surface, in the frame of the part.

    Attributes:
        unrolling: mapping to the part.
        origin_m: [m] centre of the first texel, across and up.
        texel_m: [m] distance of texels.
        kelvin: (H, W) [K] added to the temperature; rows go up, columns across.
        light: (H, W) factor on the reflected and emitted light.
    """

    unrolling: Unrolling
    origin_m: tuple[float, float]
    texel_m: float
    kelvin: NDArray[np.float32]
    light: NDArray[np.float32]


# Named colours for settings.

# Linear reflectances, not sRGB values, since light is summed before it is encoded.
COLOURS: Final[Mapping[str, Rgb]] = {
    "white": (0.75, 0.75, 0.73),
    "light_grey": (0.45, 0.45, 0.46),
    "grey": (0.22, 0.22, 0.23),
    "black": (0.02, 0.02, 0.022),
    "red": (0.48, 0.035, 0.03),
    "orange": (0.62, 0.20, 0.03),
    "yellow": (0.68, 0.52, 0.06),
    "green": (0.06, 0.25, 0.07),
    "light_blue": (0.25, 0.42, 0.62),
    "blue": (0.05, 0.11, 0.30),
    "navy": (0.015, 0.025, 0.10),
    "purple": (0.20, 0.04, 0.28),
    "pink": (0.62, 0.23, 0.32),
    "brown": (0.15, 0.07, 0.03),
    "khaki": (0.35, 0.28, 0.15),
    "dark_brown": (0.05, 0.03, 0.02),
    "blond": (0.42, 0.29, 0.11),
    "skin": (0.46, 0.27, 0.19),
}

ColourName = Literal[*COLOURS]  # type: ignore[valid-type]
Reflectances = Annotated[tuple[Share, Share, Share], Field(strict=False)]
Colour = Annotated[
    Annotated[ColourName, Tag("word")] | Annotated[Reflectances, Tag("list")], Discriminator(word_or_list)
]
"""A name, or linear red, green and blue from 0 to 1."""


def rgb_of(colour: str | Rgb) -> Rgb:
    """Return the linear reflectances of a colour, given by name or as reflectances."""
    return COLOURS[colour] if isinstance(colour, str) else colour
