"""Outfits, which change a person's outline: coats, wide trousers, hairdos, hats and bags."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from peopleboy.sim.people.body import anthropometry as table
from peopleboy.sim.people.body.anthropometry import BodySize, Sex
from peopleboy.sim.people.body.body_shapes import (
    BAG_PART,
    SIDES,
    PartGeometry,
    box,
    capsule,
    sphere,
    strand,
)
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.skeleton import ATLAS_HEIGHT, lateral
from peopleboy.sim.shapes.shapes import Shape, ShapeKind, Vector

Coat = Literal["none", "hip", "long"]
Headgear = Literal["none", "hood", "hat"]
Hairdo = Literal["plain", "bun", "tail"]
Carried = Literal["nothing", "rucksack", "shoulder_bag", "shopping_bag"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Outfit:
    """How a person wears clothes, and what the person carries; the defaults are those of the catalogue.

    Attributes:
        coat: length of a jacket: over the hips, or to the middle of the thighs.
        leg_m: [m] radius of trouser legs at their hem; 0 follows the leg.
        sleeve_m: [m] radius of sleeves at the wrist; 0 follows the arm.
        hair_m: [m] thickness of the hair.
        hairdo: style of the hair.
        headgear: hood or hat; caps belong to the catalogue.
        carried: bag on the back, at the side or in a hand.
        side: side of the bag, "left" or "right".
    """

    coat: Coat = "none"
    leg_m: float = 0.0
    sleeve_m: float = 0.0
    hair_m: float = 0.0
    hairdo: Hairdo = "plain"
    headgear: Headgear = "none"
    carried: Carried = "nothing"
    side: str = "right"

    @property
    def covers(self) -> tuple[str, ...]:
        """Parts that the top covers in addition to those of the catalogue."""
        legs = tuple(f"{side}_thigh" for side in SIDES) if self.coat == "long" else ()
        hips = () if self.coat == "none" else ("pelvis",)
        return (*hips, *legs, *(("hair",) if self.headgear == "hood" else ()))


NOTHING_MORE: Final = Outfit()

# Frequencies: our own choice.
_LONG_COAT, _OVER_HIPS = 0.3, 0.45  # shares of jackets; 0.75 of other tops reach over the hips
_HOOD_UP, _HAT = 0.12, 0.04  # shares of people whose clothes and hair allow it
_TAIL, _BUN = 0.25, 0.12  # shares of long hair
CARRIED: Final[Mapping[Carried, float]] = {
    "nothing": 0.52, "rucksack": 0.18, "shoulder_bag": 0.18, "shopping_bag": 0.12,
}  # fmt: skip
_SLEEVES_M: Final = (0.045, 0.062)
_HAIR_M: Final = {"short": 0.018, "long": 0.035}  # [m] greatest thickness
_HOOD_M: Final = 0.016  # [m] thickness of a hood
_HOODED: Final = ("jacket", "fleece")
_LONG_TOPS: Final = ("jacket", "fleece", "wool_jumper", "shirt", "t_shirt", "checked_shirt")


def draw_outfit(rng: np.random.Generator, clothes: Clothes, sex: Sex, has_bag: bool) -> Outfit:
    """Draw how a person wears the given clothes, and what they carry in addition to a configured bag."""
    reach, cover, tied, loose = (float(rng.uniform()) for _ in range(4))
    carried = list(CARRIED)[int(rng.choice(len(CARRIED), p=list(CARRIED.values())))]
    is_sleeve_wide = clothes.top in (*_HOODED, "lab_coat")
    sleeve_m = float(rng.uniform(*_SLEEVES_M)) if is_sleeve_wide else 0.0
    thickest_m = _HAIR_M.get(clothes.hair, 0.0)
    return Outfit(
        coat=_coat(clothes.top, reach),
        leg_m=_leg(clothes.bottom, sex, loose),
        sleeve_m=sleeve_m,
        hair_m=float(rng.uniform(0.0, thickest_m)) if thickest_m > 0.0 else 0.0,
        hairdo=_hairdo(tied) if clothes.hair == "long" else "plain",
        headgear=_headgear(clothes, cover),
        carried="nothing" if has_bag else carried,
        side="left" if float(rng.uniform()) < 0.5 else "right",
    )


def _hairdo(draw: float) -> Hairdo:
    if draw < _TAIL:
        return "tail"
    return "bun" if draw < _TAIL + _BUN else "plain"


def _coat(top: str, draw: float) -> Coat:
    if top == "jacket" and draw < _LONG_COAT:
        return "long"
    return "hip" if top in _LONG_TOPS and draw < _LONG_COAT + _OVER_HIPS else "none"


def _leg(bottom: str, sex: Sex, draw: float) -> float:
    """Return the radius of a trouser hem: its girth is 30 to 48 cm, women's more often narrow."""
    if bottom not in ("jeans", "trousers"):
        return 0.0
    return 0.056 + 0.020 * draw if sex == "male" else 0.046 + 0.030 * draw**2


def _headgear(clothes: Clothes, draw: float) -> Headgear:
    if clothes.hair == "cap":
        return "none"
    if draw < _HOOD_UP:
        return "hood" if clothes.top in _HOODED else "none"
    return "hat" if draw < _HOOD_UP + _HAT else "none"


def put_on(
    parts: Mapping[str, PartGeometry], size: BodySize, outfit: Outfit, thickness_m: Mapping[str, float]
) -> dict[str, PartGeometry]:
    """Change a body's parts by an outfit, add the bag, and leave out parts that are hidden."""
    h = size.stature_m
    shapes = {name: part.shapes for name, part in parts.items()}
    shapes["hair"] = _head(size, outfit, shapes["hair"])
    shapes["pelvis"] += _tails(size, outfit, thickness_m)
    for side in SIDES:
        shapes[f"{side}_thigh"] += _skirts(size, outfit, thickness_m.get(f"{side}_thigh", 0.0), side)
        shapes[f"{side}_shin"] = _hem(h, outfit.leg_m, shapes[f"{side}_shin"])
        shapes[f"{side}_forearm"] = _cuff(h, outfit.sleeve_m, shapes[f"{side}_forearm"])
    worn = {name: replace(part, shapes=shapes[name]) for name, part in parts.items()}
    if outfit.carried != "nothing":
        worn[BAG_PART] = carried_bag(size, outfit, thickness_m.get("chest", 0.0))
    return worn


def _tube(start: Vector, end: Vector, radius: float) -> Shape:
    """Make a cylinder between the centres of its two ends [m]: cloth with a straight hem."""
    return replace(capsule(start, end, radius), kind=ShapeKind.CYLINDER)


def _tails(size: BodySize, outfit: Outfit, thickness_m: Mapping[str, float]) -> tuple[Shape, ...]:
    """Make the part of a coat that hangs over the hips, a little off them."""
    if outfit.coat == "none":
        return ()
    h, g = size.stature_m, size.girths
    radius = g.buttock_depth / 2.0 * h + thickness_m.get("chest", 0.0)
    half = max(g.hip_breadth / 2.0 * h + thickness_m.get("chest", 0.0) - radius, 0.01)
    return tuple(
        _tube((-0.004 * h, y * half, -0.045 * h), (-0.002 * h, y * half * 0.85, 0.060 * h), radius)
        for y in (1.0, -1.0)
    )


def _skirts(size: BodySize, outfit: Outfit, cloth: float, side: str) -> tuple[Shape, ...]:
    """Make half of a long coat's lower end, which swings with a thigh and is wider than it."""
    if outfit.coat != "long":
        return ()
    h = size.stature_m
    length = (table.HIP_HEIGHT - table.KNEE_HEIGHT) * h
    radius = size.radius_of(size.girths.thigh_circumference) + cloth + 0.004
    ends = ((0.0, 0.0, -0.1 * length), (0.0, lateral(side) * 0.014, -0.72 * length))
    return (_tube(*ends, radius),)


def _hem(h: float, radius: float, shin: tuple[Shape, ...]) -> tuple[Shape, ...]:
    """Make a trouser leg that hangs from the knee; its end is open, and rests on the shoe."""
    if radius == 0.0:
        return shin
    shank = (table.KNEE_HEIGHT - table.ANKLE_HEIGHT) * h
    calf = shin[0]
    return (calf, _tube((-0.002 * h, 0.0, -0.1 * shank), (-0.008 * h, 0.0, -shank - 0.012), radius))


def _cuff(h: float, radius: float, forearm: tuple[Shape, ...]) -> tuple[Shape, ...]:
    """Make a sleeve as wide at the wrist as at the elbow."""
    if radius == 0.0:
        return forearm
    elbow = forearm[0]
    return (elbow, _tube((0.0, 0.0, -0.02), (0.0, 0.0, -0.97 * table.FOREARM_LENGTH * h), radius))


def _head(size: BodySize, outfit: Outfit, hair: tuple[Shape, ...]) -> tuple[Shape, ...]:
    """Make hair and headgear; a hood hides the hair."""
    h = size.stature_m
    breadth, front = size.girths.head_breadth / 2.0 * h, size.girths.head_length / 2.0 * h
    back, z = breadth - front, (1.0 - ATLAS_HEIGHT) * h - breadth
    if outfit.headgear == "hood":
        return _hood(h, breadth, back, z)
    brim = Shape(kind=ShapeKind.CYLINDER, size=(0.012, 0.085 * h, 0.0), position=(0.0, 0.0, z + 0.004 * h))
    mop = hair if outfit.hair_m == 0.0 else (*_mop(h, breadth, (back, z), outfit.hair_m), *hair[2:])
    return (*mop, *_tied(h, (back, z), outfit.hairdo), *((brim,) if outfit.headgear == "hat" else ()))


def headgear_shapes(size: BodySize, outfit: Outfit, hair: str) -> tuple[Shape, ...]:
    """Make what stands off the head of a skinned person: a peak, a brim, or tied or long hair."""
    h = size.stature_m
    breadth, front = size.girths.head_breadth / 2.0 * h, size.girths.head_length / 2.0 * h
    back, z = breadth - front, (1.0 - ATLAS_HEIGHT) * h - breadth
    if outfit.headgear == "hood":
        return ()
    brim = Shape(kind=ShapeKind.CYLINDER, size=(0.012, 0.085 * h, 0.0), position=(0.0, 0.0, z + 0.016 * h))
    shapes = _tied(h, (back, z), outfit.hairdo) + ((brim,) if outfit.headgear == "hat" else ())
    if hair == "long" and outfit.hairdo == "plain":
        shapes += tuple(strand(h, z, lateral(side)) for side in SIDES)
    if hair == "cap":
        shapes += (box((front + 0.018 * h, 0.0, z + 0.022 * h), (0.062 * h, 0.072 * h, 0.006 * h)),)
    return shapes


def _mop(h: float, breadth: float, at: tuple[float, float], thick: float) -> tuple[Shape, ...]:
    """Make hair of a given thickness [m], half as thick on top; the face stays bare."""
    back, z = at
    low, rim = z - 0.5 * thick, 0.0035 * h - thick
    skull = capsule((back, 0.0, low), (rim, 0.0, low), breadth + thick)
    return skull, sphere((back, 0.0, z - 0.03 * h), 0.9 * breadth + thick)


def _tied(h: float, at: tuple[float, float], hairdo: Hairdo) -> tuple[Shape, ...]:
    """Make a tail or bun of long hair behind the head."""
    back, z = at
    if hairdo == "bun":
        return (sphere((back - 0.045 * h, 0.0, z + 0.012 * h), 0.023 * h),)
    if hairdo == "tail":
        return (capsule((back - 0.042 * h, 0.0, z), (back - 0.052 * h, 0.0, z - 0.11 * h), 0.016 * h),)
    return ()


def _hood(h: float, breadth: float, back: float, z: float) -> tuple[Shape, ...]:
    """Make a hood over head and ears, down to the shoulders."""
    sides = tuple(
        capsule((-0.004 * h, y * 0.030 * h, z), (-0.012 * h, y * 0.032 * h, -0.035 * h), 0.022 * h)
        for y in (1.0, -1.0)
    )
    nape = capsule((-0.020 * h, 0.0, z), (-0.024 * h, 0.0, -0.035 * h), 0.034 * h)
    return (capsule((back, 0.0, z), (0.010 * h, 0.0, z), breadth + _HOOD_M), *sides, nape)


def carried_bag(size: BodySize, outfit: Outfit, cloth: float) -> PartGeometry:
    """Make a rucksack, or a bag at the hip or in a hand."""
    h, g, y = size.stature_m, size.girths, lateral(outfit.side)
    if outfit.carried == "rucksack":
        x = -(g.chest_depth / 2.0 * h + cloth + 0.05)
        ends = tuple(capsule((x, -0.06, z), (x, 0.06, z), 0.075) for z in (-0.12, 0.19))
        return PartGeometry(bone="chest", shapes=(*ends, box((x, 0.0, 0.035), (0.15, 0.27, 0.31))))
    if outfit.carried == "shoulder_bag":
        middle = (-0.02, y * (g.hip_breadth / 2.0 * h + cloth + 0.055), 0.03)
        return PartGeometry(bone="pelvis", shapes=(box(middle, (0.30, 0.10, 0.23)),))
    drop = table.HAND_LENGTH * 0.75 * h
    return PartGeometry(
        bone=f"{outfit.side}_hand", shapes=(box((0.0, 0.0, -drop - 0.19), (0.30, 0.13, 0.34)),)
    )
