"""Postures other than walking, as joint rotations."""

import math
from enum import StrEnum

import numpy as np

from peopleboy.sim.people.body.skeleton import (
    BONE_INDEX,
    BONES,
    Array,
    Vector,
    mirror,
    point_along,
    turned_back,
)


class Posture(StrEnum):
    """What a person does while standing in one place."""

    STANDING = "standing"
    SITTING = "sitting"
    BENDING = "bending"
    CROUCHING = "crouching"
    LYING = "lying"
    FALLEN = "fallen"
    ARMS_RAISED = "arms_raised"
    ARMS_CROSSED = "arms_crossed"
    CALLING = "calling"
    KNEELING = "kneeling"


def _pitch(degrees: float) -> Vector:
    """Return a pitch rotation: a trunk bends forwards, a hanging limb swings backwards."""
    return (0.0, math.radians(degrees), 0.0)


# Left limbs only: the right ones mirror them unless given.
_STANDING: dict[str, Vector] = {
    "left_upper_arm": point_along((0.02, 0.11, -1.0)),
    "left_forearm": point_along((0.16, -0.05, -1.0)),
}
_CHANGES: dict[Posture, dict[str, Vector]] = {
    Posture.STANDING: {},
    Posture.SITTING: {
        "pelvis": _pitch(-8.0),
        "left_thigh": (math.radians(4.0), math.radians(-78.0), 0.0),
        "left_shin": _pitch(86.0),
        "left_upper_arm": point_along((0.36, 0.12, -1.0)),
        "left_forearm": point_along((0.95, -0.15, -0.35)),
        "chest": _pitch(6.0),
    },
    Posture.BENDING: {
        "pelvis": _pitch(48.0),
        "abdomen": _pitch(16.0),
        "chest": _pitch(14.0),
        "head": _pitch(-16.0),
        "left_thigh": _pitch(-54.0),
        "left_shin": _pitch(14.0),
        "left_upper_arm": point_along((0.95, 0.10, -0.35)),
        "left_forearm": point_along((0.15, -0.05, -1.0)),
    },
    Posture.CROUCHING: {
        "pelvis": _pitch(38.0),
        "abdomen": _pitch(10.0),
        "chest": _pitch(8.0),
        "head": _pitch(-34.0),
        "left_thigh": (math.radians(10.0), math.radians(-148.0), 0.0),
        "left_shin": _pitch(142.0),
        "left_upper_arm": point_along((0.62, 0.12, -1.0)),
        "left_forearm": point_along((1.0, -0.30, 0.15)),
    },
    # On the back, with the arms beside the trunk.
    Posture.LYING: {
        "pelvis": _pitch(-90.0),
        "left_thigh": (math.radians(5.0), 0.0, 0.0),
        "left_foot": _pitch(25.0),
        "left_upper_arm": point_along((0.0, 0.28, -1.0)),
        "left_forearm": point_along((0.05, 0.05, -1.0)),
    },
    # On the front, with one arm above the head and one leg aside.
    Posture.FALLEN: {
        "pelvis": _pitch(90.0),
        "head": (0.0, math.radians(-6.0), math.radians(60.0)),
        "left_thigh": (math.radians(22.0), math.radians(-2.0), 0.0),
        "right_thigh": (math.radians(-6.0), 0.0, 0.0),
        "left_foot": _pitch(60.0),
        "right_foot": _pitch(60.0),
        "left_upper_arm": point_along((0.06, 0.75, 1.0)),
        "left_forearm": point_along((0.10, -0.25, -1.0)),
        "right_upper_arm": point_along((0.06, -0.35, -1.0)),
        "right_forearm": point_along((0.10, -0.10, -1.0)),
    },
    Posture.ARMS_RAISED: {
        "left_upper_arm": point_along((0.20, 0.28, 1.0)),
        "left_forearm": point_along((0.25, -0.05, -1.0)),
    },
    Posture.ARMS_CROSSED: {
        "left_upper_arm": point_along((0.40, 0.14, -1.0)),
        "right_upper_arm": point_along((0.34, -0.16, -1.0)),
    },
    Posture.CALLING: {
        "left_upper_arm": point_along((0.20, 0.34, 1.0)),
        "left_forearm": point_along((0.14, 0.0, -1.0)),
        "right_upper_arm": point_along((0.02, -0.11, -1.0)),
        "right_forearm": point_along((0.16, 0.05, -1.0)),
    },
    # On the right knee, with the hands on the left one.
    Posture.KNEELING: {
        "pelvis": _pitch(6.0),
        "chest": _pitch(4.0),
        "left_thigh": (math.radians(6.0), math.radians(-92.0), 0.0),
        "left_shin": _pitch(88.0),
        "right_thigh": (math.radians(-2.0), math.radians(-2.0), 0.0),
        "right_shin": _pitch(84.0),
        "right_foot": _pitch(72.0),
        "left_upper_arm": point_along((0.42, 0.10, -1.0)),
        "left_forearm": point_along((0.70, -0.25, -0.60)),
        "right_upper_arm": point_along((0.52, -0.06, -1.0)),
        "right_forearm": point_along((0.70, 0.50, -0.45)),
    },
}
RISE_S = 0.6  # time to sit down, to rise, or to change most other postures
_SLOW_S = 2.0  # time to lie down, and to get up from the floor
# The wave of a calling person; with the left arm, as bags are carried in the right hand.
WAVE_RAD, WAVE_HZ = math.radians(20.0), 1.2
# [fractions of stature] forward shift of pelvis and trunk that keeps the body above its feet.
_PELVIS_SHIFT = {
    Posture.SITTING: -0.13,
    Posture.BENDING: -0.075,
    Posture.CROUCHING: -0.08,
    Posture.KNEELING: -0.06,
    Posture.LYING: -0.45,
    Posture.FALLEN: 0.45,
}
_ON_THE_FLOOR = (Posture.LYING, Posture.FALLEN)
DOWN = (Posture.SITTING, Posture.KNEELING, *_ON_THE_FLOOR)
"""Postures in which a person neither turns nor stoops."""
LOW = (Posture.BENDING, Posture.CROUCHING, *DOWN)
"""Postures in which a person is not upright."""


def _both_sides(left: dict[str, Vector]) -> Array:
    """Return (17, 3) [rad] rotation vectors from those of trunk and left limbs."""
    rotations = np.zeros((len(BONES), 3))
    for bone, vector in left.items():
        rotations[BONE_INDEX[bone]] = vector
    mirrored = mirror(rotations)
    for bone, index in BONE_INDEX.items():
        if bone.startswith("right") and bone not in left:
            rotations[index] = mirrored[index]
    return rotations


def standing_rotations() -> Array:
    """Return (17, 3) [rad] rotation vectors of standing upright with hanging arms."""
    return _both_sides(_STANDING)


def posture_rotations(posture: Posture) -> Array:
    """Return (17, 3) [rad] rotation vectors of the bones in a posture; feet on the floor are level."""
    changes = _CHANGES[posture]
    rotations = _both_sides({**_STANDING, **changes})
    if posture is Posture.ARMS_CROSSED:
        _cross_forearms(rotations)
    if posture in _ON_THE_FLOOR:
        return rotations
    for side in ("left", "right"):
        if f"{side}_foot" in changes:
            continue
        leg = [BONE_INDEX[f"{side}_{bone}"] for bone in ("thigh", "shin")]
        rotations[BONE_INDEX[f"{side}_foot"], 1] = -rotations[[0, *leg], 1].sum()
    return rotations


def _cross_forearms(rotations: Array) -> None:
    """Lay the forearms across the chest, the left one above the right."""
    for side, direction in (("left", (0.26, -0.95, 0.24)), ("right", (0.26, 0.95, 0.02))):
        upper = rotations[BONE_INDEX[f"{side}_upper_arm"]]
        rotations[BONE_INDEX[f"{side}_forearm"]] = point_along(turned_back(upper, np.array(direction)))


def pelvis_shift(posture: Posture) -> float:
    """Return the forward shift of the pelvis [fractions of stature]."""
    return _PELVIS_SHIFT.get(posture, 0.0)


def change_times_s(posture: Posture) -> tuple[float, float]:
    """Return the times [s] to take up a posture, and to leave it."""
    taken_up_s = _SLOW_S if posture is Posture.LYING else RISE_S
    return taken_up_s, _SLOW_S if posture in _ON_THE_FLOOR else RISE_S
