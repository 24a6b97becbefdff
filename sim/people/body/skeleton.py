"""Bones, joints, and forward kinematics of the bones."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body import anthropometry as table
from peopleboy.sim.people.body.anthropometry import BodySize

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

# Each bone's frame sits in its upper joint. Upright with hanging arms, all frames are parallel: x to the
# person's front, y left, z up; limbs then point along -z.
PARENTS: dict[str, str | None] = {
    "pelvis": None,
    "abdomen": "pelvis",
    "chest": "abdomen",
    "neck": "chest",
    "head": "neck",
    "left_upper_arm": "chest",
    "left_forearm": "left_upper_arm",
    "left_hand": "left_forearm",
    "right_upper_arm": "chest",
    "right_forearm": "right_upper_arm",
    "right_hand": "right_forearm",
    "left_thigh": "pelvis",
    "left_shin": "left_thigh",
    "left_foot": "left_shin",
    "right_thigh": "pelvis",
    "right_shin": "right_thigh",
    "right_foot": "right_shin",
}
BONES = tuple(PARENTS)
BONE_INDEX = {name: i for i, name in enumerate(BONES)}
ARM_BONES = [i for name, i in BONE_INDEX.items() if name.endswith(("upper_arm", "forearm", "hand"))]
PARENT_INDEX = np.array([-1 if parent is None else BONE_INDEX[parent] for parent in PARENTS.values()])

# Heights at which we divide the trunk, as fractions of stature.
LUMBAR_HEIGHT = 0.585
THORAX_HEIGHT = 0.665
NECK_HEIGHT = 0.822
ATLAS_HEIGHT = 0.895


def lateral(side: str) -> float:
    """Return the sign of y on a side of the body: +1 left, -1 right."""
    return 1.0 if side == "left" else -1.0


def mirror(rotations: Array) -> Array:
    """Swap left and right in (..., 17, 3) rotation vectors."""
    swap = {"left": "right", "right": "left"}
    swapped = [BONE_INDEX["_".join(swap.get(word, word) for word in name.split("_"))] for name in BONES]
    mirrored: Array = rotations[..., swapped, :] * np.array([-1.0, 1.0, -1.0])
    return mirrored


def shoulder_half_breadth(size: BodySize) -> float:
    """Return the distance of a shoulder joint from the middle, as a fraction of stature.

    Upper arms hang a little outwards, and span the survey's bideltoid breadth.
    """
    girths = size.girths
    return girths.bideltoid_breadth / 2.0 - girths.biceps_circumference / (2.0 * math.pi) - 0.005


def joint_offsets(size: BodySize) -> Array:
    """Return (17, 3) [m] each bone's joint in its parent's frame, upright; the pelvis at the origin."""
    girths = size.girths
    shoulder_y = shoulder_half_breadth(size)
    hip_y = girths.hip_breadth / 2.0 - girths.thigh_circumference / (2.0 * math.pi) * 0.96
    offsets = {
        "pelvis": (0.0, 0.0, 0.0),
        "abdomen": (-0.006, 0.0, LUMBAR_HEIGHT - table.HIP_HEIGHT),
        "chest": (-0.004, 0.0, THORAX_HEIGHT - LUMBAR_HEIGHT),
        "neck": (-0.012, 0.0, NECK_HEIGHT - THORAX_HEIGHT),
        "head": (0.014, 0.0, ATLAS_HEIGHT - NECK_HEIGHT),
    }
    for side in ("left", "right"):
        sign = lateral(side)
        offsets[f"{side}_upper_arm"] = (0.0, sign * shoulder_y, table.SHOULDER_HEIGHT - THORAX_HEIGHT)
        offsets[f"{side}_forearm"] = (0.0, 0.0, -table.UPPER_ARM_LENGTH)
        offsets[f"{side}_hand"] = (0.0, 0.0, -table.FOREARM_LENGTH)
        offsets[f"{side}_thigh"] = (0.0, sign * hip_y, 0.0)
        offsets[f"{side}_shin"] = (0.0, 0.0, table.KNEE_HEIGHT - table.HIP_HEIGHT)
        offsets[f"{side}_foot"] = (0.0, 0.0, table.ANKLE_HEIGHT - table.KNEE_HEIGHT)
    fractions: Array = np.array([offsets[name] for name in BONES])
    return fractions * size.stature_m


def point_along(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    """Find the rotation vector [rad] that turns a hanging limb (-z) into a direction of its parent's frame.

    The rotation is the shortest; a limb that points straight up is raised forwards.
    """
    x, y, z = np.asarray(direction) / np.linalg.norm(direction)
    sine = math.hypot(x, y)
    angle = math.atan2(sine, -z)
    if sine < 1e-9:
        return (0.0, -angle, 0.0)
    return (float(y) / sine * angle, float(-x) / sine * angle, 0.0)


def turned_back(rotation: Array, direction: Array) -> Vector:
    """Return a (3,) direction in the frame of a bone that was turned by a (3,) rotation vector [rad].

    Source: Rodrigues' formula. SciPy's rotations take longer to import than a scenario to check.
    """
    angle = max(float(np.linalg.norm(rotation)), 1e-12)
    axis, cosine = rotation / angle, math.cos(angle)
    across = np.cross(axis, direction) * math.sin(angle)
    x, y, z = direction * cosine - across + axis * (axis @ direction) * (1.0 - cosine)
    return float(x), float(y), float(z)


@numba.njit(cache=True)
def _rotation(vector: Array, out: Array) -> None:
    """Write the (3, 3) matrix of a rotation vector [rad] (Rodrigues' formula)."""
    angle = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    s = 1.0 if angle < 1e-8 else math.sin(angle) / angle
    c = 0.5 if angle < 1e-4 else (1.0 - math.cos(angle)) / angle**2
    x, y, z = vector[0], vector[1], vector[2]
    out[0, 0] = 1.0 - c * (y * y + z * z)
    out[1, 1] = 1.0 - c * (x * x + z * z)
    out[2, 2] = 1.0 - c * (x * x + y * y)
    out[0, 1], out[1, 0] = c * x * y - s * z, c * x * y + s * z
    out[0, 2], out[2, 0] = c * x * z + s * y, c * x * z - s * y
    out[1, 2], out[2, 1] = c * y * z - s * x, c * y * z + s * x


@numba.njit(cache=True)
def chain(rotations: Array, offsets: Array, parents: NDArray[np.int64]) -> Array:
    """Multiply the joints' rotations down the tree: (B, 4, 4) body from bone."""
    poses = np.zeros((len(parents), 4, 4))
    local = np.empty((3, 3))
    for i in range(len(parents)):
        _rotation(rotations[i], local)
        parent = parents[i]
        poses[i, 3, 3] = 1.0
        if parent < 0:
            for row in range(3):
                poses[i, row, 3] = offsets[i, row]
                for column in range(3):
                    poses[i, row, column] = local[row, column]
            continue
        for row in range(3):
            poses[i, row, 3] = poses[parent, row, 3]
            for k in range(3):
                poses[i, row, 3] += poses[parent, row, k] * offsets[i, k]
                for column in range(3):
                    poses[i, row, column] += poses[parent, row, k] * local[k, column]
    return poses


JOINT_NAMES = (
    "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder", "left_elbow",
    "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee", "right_knee",
    "left_ankle", "right_ankle",
)  # fmt: skip
# Each lies at the start of a bone.
_BONE_OF = {
    "shoulder": "upper_arm",
    "elbow": "forearm",
    "wrist": "hand",
    "hip": "thigh",
    "knee": "shin",
    "ankle": "foot",
}


def joint_points(size: BodySize) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the bone and the position on it of each joint.

    Returns:
        (17,) index of the bone of each joint, and (17, 3) [m] the joint in that bone's frame.
    """
    bones, points = [], []
    for name in JOINT_NAMES:
        side, _, joint = name.rpartition("_")
        if joint in _BONE_OF:
            bones.append(BONE_INDEX[f"{side}_{_BONE_OF[joint]}"])
            points.append((0.0, 0.0, -0.012 if joint == "shoulder" else 0.0))
        else:
            bones.append(BONE_INDEX["head"])
            points.append(_face_point(size, joint, side))
    return np.array(bones), np.array(points) * size.stature_m


def _face_point(size: BodySize, joint: str, side: str) -> tuple[float, float, float]:
    """Return nose, eye or ear in the head's frame, as fractions of stature, just below the surface."""
    front = size.girths.head_length / 2.0
    if joint == "nose":
        return (front + 0.004, 0.0, 0.023)
    if joint == "eye":
        return (front - 0.007, lateral(side) * 0.018, table.EYE_HEIGHT - ATLAS_HEIGHT)
    return (-0.002, lateral(side) * size.girths.head_breadth / 2.0 * 0.96, 0.030)
