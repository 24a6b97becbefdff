"""Colours by name, as settings take them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Final, Literal

from pydantic import Discriminator, Field, Tag

from peopleboy.settings import Share, word_or_list
from peopleboy.sim.shapes.materials import Rgb

# Linear reflectances, not sRGB values: light is added up before it is encoded.
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
    """Return the linear reflectances of a colour that is given by name or by themselves."""
    return COLOURS[colour] if isinstance(colour, str) else colour
