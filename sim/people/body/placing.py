"""From turns of joints to bones above the floor, and to the parts that they carry (numba kernels)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.products import fma, multiply
from peopleboy.sim.people.body.skeleton import BONE_INDEX, PARENT_INDEX, chain

Array = NDArray[np.float64]


class Frame(NamedTuple):
    """How one person's parts hang together.

    Attributes:
        offsets: (17, 3) [m] from joint to joint.
        soles: (3, 3) [m] points of a sole, in the foot's frame.
        bone: (P,) that carries each part.
        part_offset: (P, 3) [m] from that bone's joint to the part's frame.
    """

    offsets: Array
    soles: Array
    bone: NDArray[np.int64]
    part_offset: Array


_FEET = (BONE_INDEX["left_foot"], BONE_INDEX["right_foot"])


@njit(cache=True, nogil=True)
def put_on_floor(
    turns: Array,
    offsets: Array,
    soles: Array,
    shift: tuple[float, float],
    place: tuple[float, float, float],
    bones: Array,
) -> None:
    """Put bones so that the lowest point of both soles is on the floor.

    Args:
        turns: (17, 3) [rad] rotation vector of each bone against its parent.
        offsets: (17, 3) [m] as `joint_offsets` gives them.
        soles: (3, 3) [m] points of a sole, in the foot's frame.
        shift: [m] the pelvis' offset to the front and to the left.
        place: x, y [m] and heading [rad] of the person.
        bones: (17, 4, 4) gets the poses, world frame.
    """
    own, world = offsets.copy(), np.eye(4)
    own[0, 0], own[0, 1], own[0, 2] = shift[0], shift[1], 0.0
    body = chain(turns, own, PARENT_INDEX)
    lowest = math.inf
    for foot in _FEET:
        for sole in soles:
            height = 0.0
            for k in range(3):
                height = fma(body[foot, 2, k], sole[k], height)
            lowest = min(lowest, height + body[foot, 2, 3])
    for bone in range(len(body)):
        body[bone, 2, 3] -= lowest
    cos, sin = math.cos(place[2]), math.sin(place[2])
    world[0, 0], world[0, 1], world[1, 0], world[1, 1] = cos, -sin, sin, cos
    world[0, 3], world[1, 3] = place[0], place[1]
    for bone in range(len(bones)):
        multiply(world, body[bone], bones[bone])


@njit(cache=True, nogil=True)
def carry(bones: Array, bone: NDArray[np.int64], offset_m: Array, poses: Array) -> None:
    """Put P parts where bones (17, 4, 4) carry them, each by its `bone`, `offset_m` from the joint."""
    for p in range(len(bone)):
        own, pose, (x, y, z) = bones[bone[p]], poses[p], offset_m[p]
        for i in range(4):
            for j in range(4):
                pose[i, j] = own[i, j]
        for i in range(3):
            pose[i, 3] += (own[i, 0] * x + own[i, 2] * z) + own[i, 1] * y
