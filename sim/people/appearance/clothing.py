"""Finishes of clothes in heat and colour: warm where cloth touches the skin, cool where it hangs, creased."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.appearance.textures import FabricSheet, Mesh, Paint, Soft, blob
from peopleboy.sim.people.appearance.traits import Traits
from peopleboy.sim.people.body.clothes import Garment

Grid = NDArray[np.float64]

# How cloth hangs: our own choice, after thermal images of people who walk by. Where cloth touches the skin,
# its temperature moves by this share towards the skin's; where it stands off, by this one towards the air's.
_LIES_ON, _STANDS_OFF = 0.85, 0.6
_THIN_M = 0.010  # cloth of this thickness passes little of the skin's heat
_GAP = 0.5  # share of the skin's warmth that shows in the openings of sleeves and collars
_CREASE_K, _CREASE_SHADE, _RELIEF_SHADE = 2.6, 0.3, 0.12
_EDGE = Soft(0.008)

OPEN = ("jacket", "lab_coat")  # garments that may be worn open, over a shirt
_BUTTONED = (*OPEN, "shirt", "checked_shirt")
_BELTED = ("jeans", "trousers", "shorts")
_TRUNK = ("chest", "abdomen", "pelvis")


@dataclass(frozen=True, slots=True, kw_only=True)
class Worn:
    """One garment on one part of a person.

    Attributes:
        part: name of the part without its side.
        garment: the garment that covers it.
        cloth_c, skin_c, air_c: [degC] mean temperature of its surface, of the skin beneath, and of the air.
        half_depth_m: [m] of the part, from its axis to the front.
        outward: 1 on the left side, -1 on the right, 0 in the middle.
        under_c: [degC] surface temperature of the shirt under an open jacket.
    """

    part: str
    garment: Garment
    cloth_c: float
    skin_c: float
    air_c: float
    half_depth_m: float
    outward: float
    under_c: float


def paint_cloth(mesh: Mesh, sheet: FabricSheet, worn: Worn) -> Paint:
    """Paint the folds of a garment without changing its mean temperature."""
    paint = Paint(mesh)
    touch = np.tanh(0.8 * sheet.touch + 1.5 * _hang(worn.part, worn.outward, mesh))
    touch -= touch.mean()
    thin = math.exp(-worn.garment.thickness_m / _THIN_M)
    warm_k = _LIES_ON * thin * (worn.skin_c - worn.cloth_c)
    cool_k = _STANDS_OFF * (worn.cloth_c - worn.air_c)
    paint.kelvin += np.where(touch > 0.0, warm_k, cool_k) * touch
    share = np.clip((worn.cloth_c - worn.air_c) / 8.0, -0.3, 1.3)
    folded = _folded(worn.part, mesh)
    paint.kelvin += _CREASE_K * share * folded * (0.45 * sheet.relief - 1.3 * sheet.crease)
    paint.centre()
    paint.light += folded * (_RELIEF_SHADE * sheet.relief - _CREASE_SHADE * sheet.crease)
    return paint


def _hang(part: str, outward: float, mesh: Mesh) -> Grid:
    """Return where cloth touches the skin (positive) and stands off (negative), folds aside."""
    down, front, left = mesh.down, mesh.front, mesh.left
    out = left * outward
    if part == "chest":
        return 1.1 * (1.0 - 1.8 * down) + 0.5 * blob(front + 1.0, down - 0.45, 0.25, 0.2) - 0.2
    if part == "abdomen":
        return -0.5 * np.clip(front, 0.0, 1.0) + 0.4 * (0.5 - down) - 0.3 * np.clip(-front, 0.0, 1.0)
    if part == "pelvis":
        return 0.4 * np.clip(-front, 0.0, 1.0) + 0.2 - 0.0 * down
    if part == "thigh":
        return 0.5 * front * (1.0 - 0.4 * down) + 0.2 * out
    if part == "shin":
        knee = 0.3 * front * np.clip(1.0 - 3.0 * down, 0.0, 1.0)
        calf = 0.4 * blob(front + 1.0, down - 0.4, 0.5, 0.2)
        return knee + calf - 0.8 * np.clip(down - 0.55, 0.0, 1.0) + 0.05
    if part == "upper_arm":
        return 0.9 * (1.0 - 2.2 * down) * (0.6 + 0.4 * out)
    return 0.3 * out - 0.0 * down


def _folded(part: str, mesh: Mesh) -> Grid:
    """Return how strongly each row is folded: most at elbows, knees, waist and over the shoes."""
    joints = {
        "chest": ((0.95, 0.25),),
        "abdomen": ((0.6, 0.4),),
        "pelvis": ((0.9, 0.4),),
        "thigh": ((0.05, 0.14), (1.0, 0.18)),
        "shin": ((0.0, 0.16), (0.95, 0.18)),
        "upper_arm": ((0.15, 0.15), (1.0, 0.3)),
        "forearm": ((0.0, 0.35), (1.0, 0.15)),
    }.get(part, ())
    return np.asarray(0.12 + sum(0.85 * np.exp(-(((mesh.down - at) / width) ** 2)) for at, width in joints))


@dataclass(frozen=True, slots=True, eq=False)
class _Surface:
    """Position of each texel on a part.

    Attributes:
        across, along: (R, C) [m] to the left, and upwards from the part's origin.
        is_front, is_back: (R, C) 1 on that side, else 0.
        down: (R, C) 0 at the top, 1 at the bottom.
    """

    across: Grid
    along: Grid
    is_front: Grid
    is_back: Grid
    down: Grid


def _surface(mesh: Mesh, worn: Worn) -> _Surface:
    # A trunk is flat in front and behind, limbs are round.
    flat = np.maximum(np.abs(mesh.front), 0.3) if worn.part in _TRUNK else 1.0
    is_front = (mesh.front > 0.0) + mesh.zeros
    across = worn.half_depth_m * mesh.left / flat + mesh.zeros
    return _Surface(across, mesh.z + mesh.zeros, is_front, 1.0 - is_front, mesh.down + mesh.zeros)


def add_trimmings(paint: Paint, worn: Worn, traits: Traits, name: str) -> None:
    """Add details to clothes: an open front or buttons, a neckline, a belt, a telephone, straps, sweat.

    Args:
        paint: the paint of the cloth.
        worn: the garment.
        traits: the traits of the person.
        name: name of the garment.
    """
    at = _surface(paint.mesh, worn)
    if worn.part in ("chest", "abdomen"):
        if name in _BUTTONED:
            _close_or_open(paint, worn, at, is_open=traits.open_jacket and name in OPEN)
        _add_straps(paint, worn, traits, at)
        _wet(paint, traits, at)
    if worn.part == "chest" and name not in (*OPEN, "fleece"):
        _cut_neckline(paint, worn, at, deep=0.33 if name in ("t_shirt", "printed_t_shirt") else 0.47)
    gap = {"forearm": (at.down - 0.9) / 0.1, "chest": (0.1 - at.down) / 0.1}.get(worn.part)
    if gap is not None:
        paint.kelvin += _GAP * (worn.skin_c - worn.cloth_c) * np.clip(gap, 0.0, 1.0)
    if worn.part == "abdomen":
        paint.lay(np.where(at.down > 0.93, 0.6, 0.0), kelvin=-0.1 * (worn.cloth_c - worn.air_c), light=0.75)
    if worn.part == "pelvis" and traits.belt and name in _BELTED:
        belt = _EDGE.within(at.along, 0.060, 0.098)
        paint.lay(0.9 * belt, kelvin=-0.25 * (worn.cloth_c - worn.air_c), light=0.3)
    if worn.part == "thigh" and traits.phone and worn.outward < 0.0 and name in _BELTED:
        _put_in_pocket(paint, worn, at)


def _close_or_open(paint: Paint, worn: Worn, at: _Surface, *, is_open: bool) -> None:
    """Draw the shirt under an open jacket, wider at the bottom, or a row of buttons."""
    if is_open:
        half = (0.02 if worn.part == "chest" else 0.05) + 0.03 * at.down
        gap = at.is_front * _EDGE.within(at.across, -half, half)
        paint.lay(gap, kelvin=worn.under_c - worn.cloth_c, cover=1.0)
    else:
        placket = at.is_front * _EDGE.within(at.across, -0.007, 0.007)
        paint.lay(0.7 * placket, kelvin=-0.12 * (worn.cloth_c - worn.air_c), light=0.75)


def _cut_neckline(paint: Paint, worn: Worn, at: _Surface, *, deep: float) -> None:
    """Draw a wedge of bare skin below the neck, down to the given share of the chest."""
    neck = at.is_front * _EDGE.within(np.abs(at.across), -1.0, 0.16 * (deep - 1.3 * at.down))
    paint.lay(neck * (at.down < deep), kelvin=worn.skin_c - worn.cloth_c - 0.4, cover=1.0)


def _put_in_pocket(paint: Paint, worn: Worn, at: _Surface) -> None:
    """Draw a cool telephone at the front of the right thigh."""
    phone = (paint.mesh.front > 0.5) * _EDGE.within(at.down, 0.22, 0.5)
    phone = phone * _EDGE.within(at.across - 0.01, -0.036, 0.036)
    paint.lay(0.8 * phone, kelvin=-0.3 * (worn.cloth_c - worn.air_c), light=0.93)


def _wet(paint: Paint, traits: Traits, at: _Surface) -> None:
    """Cool and darken the middle of the back."""
    wet = traits.sweat * at.is_back * blob(at.across, at.down - 0.5, 0.07, 0.35)
    paint.kelvin -= 2.0 * wet
    paint.light -= 0.25 * wet


def _add_straps(paint: Paint, worn: Worn, traits: Traits, at: _Surface) -> None:
    """Draw the straps of a bag over the trunk: cool and dark."""
    kelvin = -0.5 * (worn.cloth_c - worn.air_c)
    is_chest = worn.part == "chest"
    if traits.strap in ("left", "right"):
        # One line over chest and belly, whose origins are a quarter of a metre apart.
        from_left = 1.0 if traits.strap == "left" else -1.0
        slant = from_left * at.across - 0.9 * (at.along - (0.02 if is_chest else 0.28))
        paint.lay(_EDGE.within(slant, -0.026, 0.026), kelvin=kelvin, light=0.3)
    elif traits.strap == "both" and is_chest:
        outwards = np.abs(at.across) - 0.09 + 0.3 * np.minimum(at.along + 0.02, 0.0)
        paint.lay(at.is_front * _EDGE.within(outwards, -0.022, 0.022), kelvin=kelvin, light=0.3)


def paint_shoes(mesh: Mesh, sheet: FabricSheet, worn: Worn) -> Paint:
    """Paint a shoe: warm at the ankle, cool at the sole and the toes."""
    paint = Paint(mesh)
    share = np.clip((worn.cloth_c - worn.air_c) / 6.0, -0.3, 1.3)
    paint.kelvin += share * (
        1.2 * (0.6 - mesh.down) + 0.4 * sheet.touch - 0.5 * np.clip(mesh.front, 0.0, 1.0)
    )
    paint.centre()
    paint.light += 0.12 * sheet.relief * (mesh.down < 0.7)
    sole = (mesh.down > 0.82) + mesh.zeros
    paint.lay(sole, kelvin=-0.9 * float(share), light=0.6)
    return paint
