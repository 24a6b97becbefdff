"""Reaching for something: how far the trunk bends, and how the arm is turned, so that a hand is there."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.sim.people.body.anthropometry import FOREARM_LENGTH, HAND_LENGTH, UPPER_ARM_LENGTH
from peopleboy.sim.people.body.skeleton import BONE_INDEX, lateral, point_along

Array = NDArray[np.float64]

_PALM = 0.5  # of the hand's length, from the wrist
_STRETCHED = 0.97  # of the arm's length, beyond which the trunk bends
_HALVINGS = 8
_ELBOW = (-0.35, 0.45, -1.0)  # where elbows point: back, outwards and down


def arm_length(stature_m: float) -> float:
    """From the shoulder to the middle of the palm [m]."""
    return (UPPER_ARM_LENGTH + FOREARM_LENGTH + _PALM * HAND_LENGTH) * stature_m


def least_bend(gap_m: Callable[[float], float], arm_m: float) -> float:
    """How far the trunk must bend, from 0 to 1, so that the arm is long enough; 1 if it never is.

    Args:
        gap_m: from the shoulder to the target [m], when the trunk is bent so far.
        arm_m: length of the arm.
    """
    low, high = 0.0, 1.0
    if gap_m(low) <= _STRETCHED * arm_m:
        return low
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
