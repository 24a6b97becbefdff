"""Reaching for something: how far one stoops, and how the arm is turned, so that a hand is there."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.sim.people.body.anthropometry import FOREARM_LENGTH, HAND_LENGTH, UPPER_ARM_LENGTH
from peopleboy.sim.people.body.postures import Posture, pelvis_shift, posture_rotations
from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES, lateral, point_along

Array = NDArray[np.float64]

_PALM = 0.5  # of the hand's length, from the wrist
_STRETCHED = 0.97  # of the arm's length, beyond which one stoops
_DEEPEST = 2.0
_HALVINGS, _TRIED = 8, 17
_ELBOW = (-0.35, 0.45, -1.0)  # where elbows point: back, outwards and down


def _bent_knees() -> Array:
    """(17, 3) [rad] turns of the legs that lower the pelvis above the feet."""
    turns = np.zeros((len(BONES), 3))
    for bone, degrees in {"thigh": -55.0, "shin": 95.0, "foot": -40.0}.items():
        turns[[BONE_INDEX[f"{side}_{bone}"] for side in ("left", "right")], 1] = math.radians(degrees)
    return turns


_BOW = posture_rotations(Posture.BENDING) - posture_rotations(Posture.STANDING)
_KNEES = _bent_knees()


def arm_length(stature_m: float) -> float:
    """From the shoulder to the middle of the palm [m]."""
    return (UPPER_ARM_LENGTH + FOREARM_LENGTH + _PALM * HAND_LENGTH) * stature_m


def stoop(share: float) -> tuple[Array, float]:
    """Bend the trunk, from 0 to 1, and then the knees, too, from 1 to 2.

    Returns:
        (17, 3) [rad] to be added to the bones' rotation vectors; feet stay level. And how far the pelvis goes
        to the front [fractions of stature].
    """
    bow = min(share, 1.0)
    return bow * _BOW + max(share - 1.0, 0.0) * _KNEES, bow * pelvis_shift(Posture.BENDING)


def least_stoop(gap_m: Callable[[float], float], arm_m: float) -> float:
    """How far one must stoop so that the arm is long enough; where it never is, so far as gets nearest.

    Args:
        gap_m: from the shoulder to the target [m], of one who stoops so far.
        arm_m: length of the arm.
    """
    low, high = 0.0, _DEEPEST
    if gap_m(low) <= _STRETCHED * arm_m:
        return low
    if gap_m(high) > _STRETCHED * arm_m:
        tried: list[float] = np.linspace(low, high, _TRIED).tolist()
        return min(tried, key=gap_m)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if gap_m(middle) <= _STRETCHED * arm_m else (middle, high)
    return high


def turn_arm(rotations: Array, side: str, target: Array, stature_m: float) -> Array:
    """Turn an arm so that the middle of its palm is at a point, or points there if it is too far.

    Args:
        rotations: (17, 3) [rad] of the bones; not changed.
        side: "left" or "right".
        target: (3,) [m] from the shoulder, in the chest's frame.
        stature_m: of the person.

    Returns:
        (17, 3) the same with the arm turned. By the law of cosines.
    """
    upper, lower = UPPER_ARM_LENGTH * stature_m, (FOREARM_LENGTH + _PALM * HAND_LENGTH) * stature_m
    far = max(float(np.linalg.norm(target)), 1e-6)
    along = target / far
    reach = min(max(far, 1.02 * abs(upper - lower)), 0.999 * (upper + lower))
    cosine = (upper**2 + reach**2 - lower**2) / (2.0 * upper * reach)
    elbow = _across(along, side) * math.sqrt(max(1.0 - cosine**2, 0.0)) + along * cosine
    forearm = along * reach - elbow * upper
    turned = rotations.copy()
    turned[BONE_INDEX[f"{side}_upper_arm"]] = point_along(_tuple(elbow))
    back = Rotation.from_rotvec(turned[BONE_INDEX[f"{side}_upper_arm"]]).inv()
    turned[BONE_INDEX[f"{side}_forearm"]] = point_along(_tuple(back.apply(forearm)))
    turned[BONE_INDEX[f"{side}_hand"]] = 0.0
    return turned


def _across(along: Array, side: str) -> Array:
    """The unit vector across a direction that comes nearest to where elbows point."""
    x, y, z = _ELBOW
    pole = np.array([x, lateral(side) * y, z])
    across = pole - (pole @ along) * along
    return np.asarray(across / max(float(np.linalg.norm(across)), 1e-9))


def _tuple(vector: Array) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
