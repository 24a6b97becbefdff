"""The 17 points of the COCO skeleton on a body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body import anthropometry as table
from peopleboy.sim.people.body.anthropometry import BodySize
from peopleboy.sim.people.body.skeleton import ATLAS_HEIGHT, BONE_INDEX, lateral

JOINT_NAMES = (
    "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder", "left_elbow",
    "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee", "right_knee",
    "left_ankle", "right_ankle",
)  # fmt: skip
# Each lies where a bone begins.
_BONE_OF = {
    "shoulder": "upper_arm",
    "elbow": "forearm",
    "wrist": "hand",
    "hip": "thigh",
    "knee": "shin",
    "ankle": "foot",
}


def joint_points(size: BodySize) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Tie the joints to the bones.

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
    """Nose, eye or ear in the head's frame, as fractions of stature, just below the surface."""
    front = size.girths.head_length / 2.0
    if joint == "nose":
        return (front + 0.004, 0.0, 0.023)
    if joint == "eye":
        return (front - 0.007, lateral(side) * 0.018, table.EYE_HEIGHT - ATLAS_HEIGHT)
    return (-0.002, lateral(side) * size.girths.head_breadth / 2.0 * 0.96, 0.030)
