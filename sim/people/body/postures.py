"""Postures other than walking, as turns of the joints."""

from __future__ import annotations

import math
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES, mirror, point_along

Array = NDArray[np.float64]
Vector = tuple[float, float, float]


class Posture(StrEnum):
    """What a person does while standing in one place."""

    STANDING = "standing"
    SITTING = "sitting"
    BENDING = "bending"
    ARMS_RAISED = "arms_raised"
    ARMS_CROSSED = "arms_crossed"
    CALLING = "calling"


def _pitch(degrees: float) -> Vector:
    """Turn towards the front (a trunk that bends) or to the back (a hanging limb)."""
    return (0.0, math.radians(degrees), 0.0)


# Left limbs only: the right ones mirror them, unless given.
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
}
RISE_S = 0.6  # the time that it takes to sit down, to rise, or to change any other posture
# Who calls waves so; the left arm, as bags are carried in the right hand.
WAVE_RAD, WAVE_HZ = math.radians(20.0), 1.2
# [fractions of stature] how far pelvis and trunk move to the front, so that the body stays above its feet.
_PELVIS_SHIFT = {Posture.SITTING: -0.13, Posture.BENDING: -0.075}


def _both_sides(left: dict[str, Vector]) -> Array:
    """(17, 3) [rad] rotation vectors from those of trunk and left limbs."""
    rotations = np.zeros((len(BONES), 3))
    for bone, vector in left.items():
        rotations[BONE_INDEX[bone]] = vector
    mirrored = mirror(rotations)
    for bone, index in BONE_INDEX.items():
        if bone.startswith("right") and bone not in left:
            rotations[index] = mirrored[index]
    return rotations


def standing_rotations() -> Array:
    """(17, 3) [rad] upright, the arms hanging."""
    return _both_sides(_STANDING)


def posture_rotations(posture: Posture) -> Array:
    """(17, 3) [rad] the bones' rotation vectors in a posture; feet stay level."""
    rotations = _both_sides({**_STANDING, **_CHANGES[posture]})
    if posture is Posture.ARMS_CROSSED:
        _cross_forearms(rotations)
    for side in ("left", "right"):
        leg = [BONE_INDEX[f"{side}_{bone}"] for bone in ("thigh", "shin")]
        rotations[BONE_INDEX[f"{side}_foot"], 1] = -rotations[[0, *leg], 1].sum()
    return rotations


def _cross_forearms(rotations: Array) -> None:
    """Lay the forearms across the chest, the left one above the right."""
    for side, direction in (("left", (0.26, -0.95, 0.24)), ("right", (0.26, 0.95, 0.02))):
        upper = Rotation.from_rotvec(rotations[BONE_INDEX[f"{side}_upper_arm"]])
        in_arm = upper.inv().apply(np.array(direction))
        rotations[BONE_INDEX[f"{side}_forearm"]] = point_along((in_arm[0], in_arm[1], in_arm[2]))


def pelvis_shift(posture: Posture) -> float:
    """How far the pelvis moves to the front [fractions of stature]."""
    return _PELVIS_SHIFT.get(posture, 0.0)
