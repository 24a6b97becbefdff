"""Finishes of faces, hair and bare skin in heat and colour."""

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.appearance.textures import FabricSheet, Mesh, Paint, Soft, blob, streaks
from peopleboy.sim.people.appearance.traits import Traits
from peopleboy.sim.people.body.anthropometry import CHIN_HEIGHT, EYE_HEIGHT
from peopleboy.sim.people.body.skeleton import ATLAS_HEIGHT

Grid = NDArray[np.float64]

# Heights and half distances as fractions of stature, from the head's joint; eyes 63 mm apart at 1.75 m.
_EYES, _CHIN = EYE_HEIGHT - ATLAS_HEIGHT, CHIN_HEIGHT - ATLAS_HEIGHT
_BROWS, _NOSE, _MOUTH = _EYES + 0.011, _EYES - 0.020, _EYES - 0.041
_EYE_ASIDE, _RADIUS = 0.018, 0.055
# [K] against the forehead: cornea -0.1, inner corner +0.9, outer corner -0.6 (Micheletti et al. 2022,
# doi 10.1167/tvst.11.12.15, 20 people). Warm, too, are the corners of the mouth; cool are nose, cheeks and
# lower lip (Haddad et al. 2016, doi 10.1259/dmfr.20150264), by amounts that are our choice.
_INNER_K, _CORNEA_K, _OUTER_K = 0.9, -0.1, -0.6
_NOSE_K, _CHEEK_K, _MOUTH_K, _LIP_K, _EAR_K, _BEARD_K = -1.6, -0.7, 0.2, -0.4, -1.5, -1.3
_COLD = 0.25  # [K/K] extra cooling of nose and ears per kelvin of the air below 21 degC
_GLASS_SHARE = 0.4  # glass is opaque to long-wave infrared: 0 is the air's temperature, 1 the face's


def paint_face(mesh: Mesh, stature_m: float, face_c: float, air_c: float, traits: Traits) -> Paint:
    """Paint a head with eyes, brows, nose, cheeks, mouth, ears, beard and glasses, as `Traits` say."""
    paint = Paint(mesh)
    y = _RADIUS * mesh.left + 0.0 * mesh.z
    z = mesh.z / stature_m + 0.0 * mesh.turn
    aside = np.abs(y) - _EYE_ASIDE
    is_front = (mesh.front > 0.15) + mesh.zeros
    colder_k = -_COLD * max(21.0 - air_c, 0.0)
    tip_k = _NOSE_K + traits.nose_k + colder_k
    for kelvin, across, height, wide, tall in (
        (_INNER_K, np.abs(y) - 0.0085, _EYES, 0.004, 0.004),
        (_CORNEA_K, aside, _EYES, 0.007, 0.004),
        (_OUTER_K, np.abs(y) - 0.028, _EYES, 0.005, 0.004),
        (tip_k, y, _NOSE, 0.007, 0.011),
        (_CHEEK_K + 0.4 * colder_k, np.abs(y) - 0.026, _NOSE - 0.004, 0.011, 0.012),
        (_MOUTH_K, np.abs(y) - 0.014, _MOUTH, 0.004, 0.003),
        (_LIP_K, y, _MOUTH - 0.006, 0.010, 0.005),
        (0.5 * colder_k, y, _CHIN, 0.02, 0.01),
    ):
        paint.kelvin += kelvin * is_front * blob(across, z - height, wide, tall)
    ears = blob(mesh.front + 0.05, z - 0.030, 0.16, 0.012) * (np.abs(mesh.left) > 0.8)
    paint.kelvin += (_EAR_K + colder_k) * ears
    paint.centre()
    if traits.beard:
        beard = is_front * Soft(0.008).within(
            z, -0.2, _MOUTH + 0.012 + 0.25 * np.maximum(np.abs(y) - 0.02, 0.0)
        )
        beard = beard * (1.0 - blob(y, z - _MOUTH, 0.009, 0.003))
        paint.kelvin += _BEARD_K * beard
        paint.cover += 0.6 * beard
    _draw_features(paint, y, z, aside, is_front)
    if traits.glasses:
        _put_on_glasses(paint, y, z, aside, is_front, (1.0 - _GLASS_SHARE) * (air_c - face_c))
    return paint


def _draw_features(paint: Paint, y: Grid, z: Grid, aside: Grid, is_front: Grid) -> None:
    """Darken the features of a face that a colour camera sees."""
    fine = Soft(0.002)
    paint.light -= 0.18 * is_front * blob(aside, z - _EYES - 0.001, 0.013, 0.006)
    paint.light -= 0.25 * is_front * blob(y, z - _NOSE + 0.009, 0.006, 0.002)
    paint.light += 0.08 * is_front * blob(y, z - _NOSE - 0.006, 0.003, 0.012)
    paint.light += 0.45 * is_front * fine.oval(aside, z - _EYES, 0.0075, 0.0032)
    iris = is_front * fine.oval(aside, z - _EYES, 0.0030, 0.0032)
    lashes = is_front * fine.oval(aside, z - _EYES - 0.0035, 0.0085, 0.0013)
    brows = is_front * fine.oval(aside - 0.001, z - _BROWS, 0.0115, 0.0024)
    mouth = is_front * fine.oval(y, z - _MOUTH, 0.0145, 0.0036)
    line = is_front * fine.oval(y, z - _MOUTH, 0.0145, 0.0010)
    paint.light *= 1.0 - 0.85 * iris
    paint.light *= 1.0 - 0.6 * lashes
    paint.light *= (1.0 - 0.28 * mouth) * (1.0 - 0.4 * line)
    paint.cover = np.maximum(paint.cover, 0.85 * brows)


def _put_on_glasses(paint: Paint, y: Grid, z: Grid, aside: Grid, is_front: Grid, kelvin: float) -> None:
    fine = Soft(0.002)
    lens = is_front * fine.oval(aside, z - _EYES + 0.001, 0.0150, 0.0118)
    hole = is_front * fine.oval(aside, z - _EYES + 0.001, 0.0134, 0.0102)
    bridge = is_front * fine.within(np.abs(y), -1.0, 0.005) * fine.within(z, _EYES + 0.002, _EYES + 0.004)
    arm = (np.abs(y) > 0.032) * fine.within(z, _EYES + 0.002, _EYES + 0.005) * (paint.mesh.front > -0.05)
    light = paint.light.copy()
    for share in (lens, bridge, 0.6 * arm):
        paint.lay(share, kelvin=kelvin, light=0.1)
    paint.light += hole * (0.95 * light - paint.light)


def paint_hair(
    mesh: Mesh, stature_m: float, hair: str, share: float, traits: Traits, rng: np.random.Generator
) -> Paint:
    """Paint hair in strands, parted, warm at the hairline and cool at the tips; a cap in soft folds.

    Args:
        mesh: grid of the hair.
        stature_m: [m] stature of the person.
        hair: name of the hair or cap in the catalogue.
        share: factor on the contrasts, 1 in a room.
        traits: the traits of the person.
        rng: draws the strands.
    """
    paint = Paint(mesh)
    wide, long = (0.05, 0.05) if hair == "cap" else (0.014, 0.16)
    strands = streaks(mesh, wide, long, rng)
    paint.kelvin += share * 0.45 * strands
    paint.light += (0.08 if hair == "cap" else 0.22) * strands
    z = mesh.z / stature_m + 0.0 * mesh.turn
    if hair in ("short", "long"):
        y = _RADIUS * mesh.left + 0.0 * mesh.z
        hairline = blob(mesh.front - 1.0, z - 0.075, 0.35, 0.014)
        sides = blob(mesh.front, z - 0.03, 0.5, 0.02) * (mesh.front > -0.7)
        paint.kelvin += share * (1.5 * hairline + 0.8 * sides - 0.4 * np.clip(-mesh.front, 0.0, 1.0))
        paint.kelvin += share * np.clip(8.0 * z, -0.9, 0.0) * 1.6
        paint.centre()
        if traits.parting != 0.0:
            part = blob(y - 0.016 * traits.parting, 0.0 * z, 0.0022, 1.0) * (mesh.front > 0.0) * (z > 0.078)
            paint.kelvin += 2.2 * share * part
            paint.cover += 0.6 * part
    return paint


def paint_skin(mesh: Mesh, sheet: FabricSheet, part: str, tip_k: float) -> Paint:
    """Paint bare skin: blotched, cooler over joints, and cooler towards the tip by `tip_k` [K]."""
    paint = Paint(mesh)
    paint.kelvin += 0.35 * sheet.touch + tip_k * (mesh.down - 0.5)
    joint = {"forearm": 0.0, "shin": 0.0, "thigh": 1.0, "upper_arm": 1.0}.get(part)
    if joint is not None:
        is_front = mesh.front if part in ("shin", "thigh") else -mesh.front
        paint.kelvin -= 0.8 * np.exp(-(((mesh.down - joint) / 0.12) ** 2)) * np.clip(is_front, 0.0, 1.0)
    paint.centre()
    paint.light += 0.03 * sheet.relief
    if part == "hand":
        gaps = np.abs(np.sin(3.0 * mesh.turn)) < 0.22
        paint.light -= 0.25 * gaps * (mesh.down > 0.45)
    return paint
