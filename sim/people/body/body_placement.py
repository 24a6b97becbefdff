"""Forward kinematics from joint rotations to bones and parts above the floor, and reaching for a point."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import fma, multiply
from peopleboy.sim.people.body.anthropometry import FOREARM_LENGTH, HAND_LENGTH, UPPER_ARM_LENGTH
from peopleboy.sim.people.body.body_shapes import SUPPORTS
from peopleboy.sim.people.body.postures import Posture, pelvis_shift, posture_rotations
from peopleboy.sim.people.body.skeleton import (
    BONE_INDEX,
    BONES,
    PARENT_INDEX,
    chain,
    lateral,
    point_along,
    turned_back,
)

Array = NDArray[np.float64]


class BodyFrame(NamedTuple):
    """The geometry that connects one person's bones and parts.

    Attributes:
        offsets: (17, 3) [m] from joint to joint.
        supports: (12, 3) [m] points that the body may rest on, in the order of `SUPPORTS`.
        bone: (P,) index in `FRAME_INDEX` of the frame that carries each part.
        part_offset: (P, 3) [m] from that bone's joint to the part's frame.
    """

    offsets: Array
    supports: Array
    bone: NDArray[np.int64]
    part_offset: Array


_SUPPORTS = np.array([BONE_INDEX[bone] for bone in SUPPORTS])


@njit(cache=True, nogil=True)
def put_on_floor(
    turns: Array,
    offsets: Array,
    supports: Array,
    shift: tuple[float, float, float],
    place: tuple[float, float, float],
    bones: Array,
) -> None:
    """Place bones so that the lowest point of the body, usually of a sole, is on the floor or above it.

    Args:
        turns: (17, 3) [rad] rotation vector of each bone against its parent.
        offsets: (17, 3) [m] joint offsets as returned by `joint_offsets`.
        supports: (12, 3) [m] as in `BodyFrame`.
        shift: [m] offset of the pelvis to the front and to the left, and the height of the lowest point.
        place: x, y [m] and heading [rad] of the person.
        bones: (18, 4, 4) output: the poses in the world frame, and that of the floor under the person.
    """
    own, world = offsets.copy(), np.eye(4)
    own[0, 0], own[0, 1], own[0, 2] = shift[0], shift[1], 0.0
    body = chain(turns, own, PARENT_INDEX)
    lowest = math.inf
    for point in range(len(supports)):
        bone, height = _SUPPORTS[point], 0.0
        for k in range(3):
            height = fma(body[bone, 2, k], supports[point, k], height)
        lowest = min(lowest, height + body[bone, 2, 3])
    for bone in range(len(body)):
        body[bone, 2, 3] += shift[2] - lowest
    cos, sin = math.cos(place[2]), math.sin(place[2])
    world[0, 0], world[0, 1], world[1, 0], world[1, 1] = cos, -sin, sin, cos
    world[0, 3], world[1, 3] = place[0], place[1]
    for bone in range(len(body)):
        multiply(world, body[bone], bones[bone])
    bones[len(body)] = world


@njit(cache=True, nogil=True)
def carry(bones: Array, bone: NDArray[np.int64], offset_m: Array, poses: Array) -> None:
    """Return the poses of P parts carried by bones (18, 4, 4), `offset_m` from the joint of their `bone`."""
    for p in range(len(bone)):
        own, pose, (x, y, z) = bones[bone[p]], poses[p], offset_m[p]
        for i in range(4):
            for j in range(4):
                pose[i, j] = own[i, j]
        for i in range(3):
            pose[i, 3] += (own[i, 0] * x + own[i, 2] * z) + own[i, 1] * y


_PALM = 0.5  # position of the palm as a share of the hand's length, from the wrist
_STRETCHED = 0.97  # share of the arm's length beyond which a person stoops
_DEEPEST = 2.0
_HALVINGS, _TRIED = 8, 17
_ELBOW = (-0.35, 0.45, -1.0)  # where elbows point: back, outwards and down


def _bent_knees() -> Array:
    """Return the (17, 3) [rad] leg rotations that lower the pelvis above the feet."""
    turns = np.zeros((len(BONES), 3))
    for bone, degrees in {"thigh": -55.0, "shin": 95.0, "foot": -40.0}.items():
        turns[[BONE_INDEX[f"{side}_{bone}"] for side in ("left", "right")], 1] = math.radians(degrees)
    return turns


_BOW = posture_rotations(Posture.BENDING) - posture_rotations(Posture.STANDING)
_KNEES = _bent_knees()


def arm_lengths(stature_m: float) -> tuple[float, float]:
    """Return the distances from shoulder to elbow and from there to the middle of the palm [m]."""
    return UPPER_ARM_LENGTH * stature_m, (FOREARM_LENGTH + _PALM * HAND_LENGTH) * stature_m


def stoop(share: float) -> tuple[Array, float]:
    """Return the posture of a stoop: 0 to 1 bends the trunk, 1 to 2 the knees as well.

    Returns:
        (17, 3) [rad] to be added to the bones' rotation vectors; feet stay level. And the shift of the
        pelvis to the front [fractions of stature].
    """
    bow = min(share, 1.0)
    return bow * _BOW + max(share - 1.0, 0.0) * _KNEES, bow * pelvis_shift(Posture.BENDING)


def least_stoop(gap_m: Callable[[float], float], arm_m: float) -> float:
    """Return the least stoop at which the arm reaches the target, or the one that gets nearest to it.

    Args:
        gap_m: maps a stoop to the distance [m] from the shoulder to the target.
        arm_m: [m] length of the arm.
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


def turn_arm(rotations: Array, side: str, target: Array, arm_m: tuple[float, float]) -> Array:
    """Turn an arm so that its palm is at a point, or points at it if it is out of reach.

    Args:
        rotations: (17, 3) [rad] rotation vectors of the bones; not changed.
        side: "left" or "right".
        target: (3,) [m] from the shoulder, in the chest's frame.
        arm_m: [m] as returned by `arm_lengths`.

    Returns:
        (17, 3) [rad] the rotations with the arm turned, by the law of cosines.
    """
    upper, lower = arm_m
    far = max(float(np.linalg.norm(target)), 1e-6)
    along = target / far
    reach = min(max(far, 1.02 * abs(upper - lower)), 0.999 * (upper + lower))
    cosine = (upper**2 + reach**2 - lower**2) / (2.0 * upper * reach)
    elbow = _across(along, side) * math.sqrt(max(1.0 - cosine**2, 0.0)) + along * cosine
    forearm = along * reach - elbow * upper
    turned = rotations.copy()
    turned[BONE_INDEX[f"{side}_upper_arm"]] = point_along(_tuple(elbow))
    upper_arm = turned[BONE_INDEX[f"{side}_upper_arm"]]
    turned[BONE_INDEX[f"{side}_forearm"]] = point_along(turned_back(upper_arm, forearm))
    turned[BONE_INDEX[f"{side}_hand"]] = 0.0
    return turned


def _across(along: Array, side: str) -> Array:
    """Return the unit vector perpendicular to a direction that is nearest to where elbows point."""
    x, y, z = _ELBOW
    pole = np.array([x, lateral(side) * y, z])
    across = pole - (pole @ along) * along
    return np.asarray(across / max(float(np.linalg.norm(across)), 1e-9))


def _tuple(vector: Array) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
