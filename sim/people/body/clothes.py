"""Clothes, hair and skin: the parts of a person that they cover, their temperatures and colours."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.sim.people.body.body_shapes import BODY_PARTS, SIDES
from peopleboy.sim.shapes.materials import COLOURS, Colour, Material, Pattern, PatternKind, Rgb
from peopleboy.wording import hint


def _both(*parts: str) -> tuple[str, ...]:
    return tuple(f"{side}_{part}" for part in parts for side in SIDES)


_TRUNK = ("chest", "abdomen")
_UPPER_ARMS, _SLEEVES = _both("upper_arm"), _both("upper_arm", "forearm")
_LEGS = ("pelvis", *_both("thigh", "shin"))
_PLAIN = Pattern()

ROOM_C: Final = 21.0
"""[degC] air for which the catalogue's temperatures hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Garment:
    """One garment of the catalogue.

    Attributes:
        covers: names of the parts that it covers.
        temperature_c: [degC] mean surface temperature indoors; thicker garments are cooler.
        thickness_m: [m] distance from the skin.
        variation_k: [K] amplitude of folds and gaps: smooth variation over the surface.
        contrast_k, thermal_pattern: pattern on the chest in thermal images, and its contrast [K].
        colour_pattern: pattern in colour images, on all parts that the garment covers.
        colour: name of its usual colour.
    """

    covers: tuple[str, ...]
    temperature_c: float
    thickness_m: float = 0.004
    variation_k: float = 0.4
    contrast_k: float = 0.0
    thermal_pattern: Pattern = field(default_factory=Pattern)
    colour_pattern: Pattern = field(default_factory=Pattern)
    colour: str = "grey"


_STRIPES = Pattern(kind=PatternKind.STRIPES, period_m=0.11)
_CHECKS = Pattern(kind=PatternKind.CHECKS, period_m=0.07)
_PRINT = Pattern(kind=PatternKind.PATCH, period_m=0.24)

TOPS: dict[str, Garment] = {
    "t_shirt": Garment(covers=(*_TRUNK, *_UPPER_ARMS), temperature_c=30.6, thickness_m=0.003, colour="white"),
    "printed_t_shirt": Garment(
        covers=(*_TRUNK, *_UPPER_ARMS),
        temperature_c=30.4,
        thickness_m=0.003,
        contrast_k=-2.6,
        thermal_pattern=_PRINT,
        colour_pattern=_PRINT,
        colour="black",
    ),
    "shirt": Garment(covers=(*_TRUNK, *_SLEEVES), temperature_c=30.0, colour="light_blue"),
    "checked_shirt": Garment(
        covers=(*_TRUNK, *_SLEEVES), temperature_c=30.0, colour_pattern=_CHECKS, colour="red"
    ),
    "wool_jumper": Garment(
        covers=(*_TRUNK, *_SLEEVES), temperature_c=28.6, thickness_m=0.009, variation_k=0.5, colour="green"
    ),
    "striped_jumper": Garment(
        covers=(*_TRUNK, *_SLEEVES),
        temperature_c=28.4,
        thickness_m=0.009,
        contrast_k=2.4,
        thermal_pattern=_STRIPES,
        colour_pattern=_STRIPES,
        colour="navy",
    ),
    "fleece": Garment(
        covers=(*_TRUNK, *_SLEEVES), temperature_c=28.1, thickness_m=0.012, variation_k=0.5, colour="orange"
    ),
    "jacket": Garment(
        covers=(*_TRUNK, *_SLEEVES), temperature_c=27.4, thickness_m=0.016, variation_k=0.6, colour="brown"
    ),
    "lab_coat": Garment(
        covers=(*_TRUNK, *_SLEEVES, "pelvis", *_both("thigh")),
        temperature_c=29.2,
        thickness_m=0.014,
        variation_k=0.6,
        colour="white",
    ),
}
BOTTOMS: dict[str, Garment] = {
    "jeans": Garment(covers=_LEGS, temperature_c=29.2, thickness_m=0.006, colour="blue"),
    "trousers": Garment(covers=_LEGS, temperature_c=29.6, thickness_m=0.009, colour="black"),
    "leggings": Garment(covers=_LEGS, temperature_c=30.6, thickness_m=0.001, colour="black"),
    "shorts": Garment(
        covers=("pelvis", *_both("thigh")), temperature_c=29.8, thickness_m=0.010, colour="khaki"
    ),
    "skirt": Garment(
        covers=("pelvis", *_both("thigh")), temperature_c=29.4, thickness_m=0.014, colour="purple"
    ),
}
SHOES: dict[str, Garment] = {
    "trainers": Garment(covers=_both("foot"), temperature_c=27.0, variation_k=0.4, colour="white"),
    "leather_shoes": Garment(covers=_both("foot"), temperature_c=26.2, variation_k=0.3, colour="brown"),
    "boots": Garment(covers=_both("foot"), temperature_c=25.4, variation_k=0.3, colour="black"),
    "sandals": Garment(covers=_both("foot"), temperature_c=27.8, variation_k=0.6, colour="khaki"),
}
HAIR: dict[str, Garment] = {
    "short": Garment(covers=("hair",), temperature_c=29.6, variation_k=0.5, colour="dark_brown"),
    "long": Garment(covers=("hair",), temperature_c=28.8, variation_k=0.5, colour="blond"),
    "cap": Garment(covers=("hair",), temperature_c=28.5, variation_k=0.3, colour="navy"),
    "bald": Garment(covers=("hair",), temperature_c=33.6, variation_k=0.3, colour="skin"),
}
# [degC] bare skin in a room: the face is warmest, the legs are coolest.
SKIN_C = {"head": 34.2, "neck": 33.9, "hand": 32.8, "forearm": 32.6, "upper_arm": 32.6, "foot": 30.5}
_OTHER_SKIN_C = 32.2
_EMISSIVITY = {"skin": 0.98, "cloth": 0.95}
_KINDS = {"top": TOPS, "bottom": BOTTOMS, "shoes": SHOES, "hair": HAIR}


TopName = Literal[*TOPS]  # type: ignore[valid-type]
BottomName = Literal[*BOTTOMS]  # type: ignore[valid-type]
ShoesName = Literal[*SHOES]  # type: ignore[valid-type]
HairName = Literal[*HAIR]  # type: ignore[valid-type]


@dataclass(frozen=True, slots=True, kw_only=True)
class Clothes:
    """Clothes of a person, by names of the catalogue; a colour of None is the garment's usual one.

    Raises:
        BadInput: a garment or colour is not in the catalogue.
    """

    top: Annotated[TopName, Field(description="upper garment")] = "shirt"
    bottom: Annotated[BottomName, Field(description="lower garment")] = "trousers"
    shoes: Annotated[ShoesName, Field(description="shoes")] = "leather_shoes"
    hair: Annotated[HairName, Field(description="hair style, or a cap")] = "short"
    top_colour: Annotated[Colour | None, Field(description="colour of the top")] = None
    bottom_colour: Annotated[Colour | None, Field(description="colour of the bottom")] = None
    hair_colour: Annotated[Colour | None, Field(description="colour of the hair")] = None

    def __post_init__(self) -> None:
        for kind, catalogue in _KINDS.items():
            _check_name(kind, getattr(self, kind), catalogue)
        for key in ("top_colour", "bottom_colour", "hair_colour"):
            value = getattr(self, key)
            if value is not None:
                _resolve_colour(key, value)

    def garments(self) -> tuple[tuple[Garment, Rgb], ...]:
        """All garments with their colours, from the skin outwards."""
        top, bottom, shoes, hair = TOPS[self.top], BOTTOMS[self.bottom], SHOES[self.shoes], HAIR[self.hair]
        return (
            (hair, _resolve_colour("hair_colour", self.hair_colour or hair.colour)),
            (shoes, COLOURS[shoes.colour]),
            (bottom, _resolve_colour("bottom_colour", self.bottom_colour or bottom.colour)),
            (top, _resolve_colour("top_colour", self.top_colour or top.colour)),
        )

    def thickness_m(self) -> dict[str, float]:
        """[m] distance of clothes from the skin, by part."""
        return {part: garment.thickness_m for garment, _ in self.garments() for part in garment.covers}


def _check_name(key: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        raise BadInput(f"unknown {name!r}; {hint(str(name), known)}", key=(key,))


def _resolve_colour(key: str, colour: str | Rgb) -> Rgb:
    if isinstance(colour, str):
        _check_name(key, colour, COLOURS)
        return COLOURS[colour]
    if len(colour) != 3 or not all(0.0 <= channel <= 1.0 for channel in colour):
        raise BadInput(f"{colour!r} must be a name or three linear reflectances 0..1", key=(key,))
    return colour


def dress(clothes: Clothes, rng: np.random.Generator) -> dict[str, Material]:
    """Return the material of every part of a person.

        People differ: each person's skin and each garment is up to half a kelvin warmer or cooler than the
    catalogue says, and complexions differ.

    Returns:
        Material by part name.
    """
    skin_c = float(rng.uniform(-0.5, 0.5))
    complexion = tuple(float(c) for c in np.array(COLOURS["skin"]) * rng.uniform(0.35, 1.25))
    materials = {
        part: _skin(part, skin_c, (complexion[0], complexion[1], complexion[2])) for part in BODY_PARTS
    }
    for garment, rgb in clothes.garments():
        offset_k = float(rng.uniform(-0.5, 0.5))
        is_bare = garment.colour == "skin"
        for part in garment.covers:
            material = _cloth(garment, part, offset_k, rgb)
            materials[part] = (
                replace(material, rgb=materials["head"].rgb, emissivity=0.98) if is_bare else material
            )
    return materials


def _skin(part: str, offset_k: float, rgb: Rgb) -> Material:
    bare = part.removeprefix("left_").removeprefix("right_")
    return Material(
        temperature_c=SKIN_C.get(bare, _OTHER_SKIN_C) + offset_k,
        emissivity=_EMISSIVITY["skin"],
        variation_k=0.5 if part == "head" else 0.3,
        variation_m=0.09 if part == "head" else 0.15,
        rgb=rgb,
    )


def _cloth(garment: Garment, part: str, offset_k: float, rgb: Rgb) -> Material:
    is_front = part == "chest" or garment.thermal_pattern.kind is not PatternKind.PATCH
    return Material(
        temperature_c=garment.temperature_c + offset_k,
        emissivity=_EMISSIVITY["cloth"],
        variation_k=garment.variation_k,
        variation_m=0.22,
        contrast_k=garment.contrast_k if is_front else 0.0,
        thermal_pattern=garment.thermal_pattern if is_front else _PLAIN,
        rgb=rgb,
        second_rgb=_second_colour(rgb),
        colour_pattern=garment.colour_pattern if is_front else _PLAIN,
    )


def _second_colour(rgb: Rgb) -> Rgb:
    """Return a light colour for dark clothes, a dark one for light clothes."""
    return COLOURS["white"] if sum(rgb) < 0.9 else COLOURS["navy"]


def random_clothes(rng: np.random.Generator) -> Clothes:
    """Draw clothes from the whole catalogue."""
    colours = [name for name in COLOURS if name not in {"skin", "blond", "dark_brown"}]

    def pick(names: Iterable[str]) -> str:
        return str(rng.choice(list(names)))

    return Clothes(
        top=pick(TOPS),
        bottom=pick(BOTTOMS),
        shoes=pick(SHOES),
        hair=pick(HAIR),
        top_colour=pick(colours),
        bottom_colour=pick(colours),
        hair_colour=None,
    )
