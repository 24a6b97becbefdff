"""People as bodies of capsules, from their 17 joints."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Indices of the COCO keypoints.
_EARS, _SHOULDERS, _ELBOWS, _WRISTS = (3, 4), (5, 6), (7, 8), (9, 10)
_HIPS, _KNEES, _ANKLES = (11, 12), (13, 14), (15, 16)

# Radii in shares of the height from ankles to ears: the look of a person, not anybody's measures.
_LIMBS: Final[tuple[tuple[tuple[int, int], tuple[int, int], float], ...]] = (
    (_SHOULDERS, _ELBOWS, 0.033),
    (_ELBOWS, _WRISTS, 0.025),
    (_HIPS, _KNEES, 0.050),
    (_KNEES, _ANKLES, 0.035),
    (_SHOULDERS, _HIPS, 0.065),
)
_ACROSS_RADIUS: Final = 0.050
_TRUNK_RADIUS: Final = 0.075
_HEAD_RADIUS: Final = 0.058


@dataclass(frozen=True, slots=True, eq=False)
class Capsules:
    """K capsules: from a cap's centre along their own z axis to the other's.

    Attributes:
        start: (K, 3) [m] world frame.
        quaternion: (K, 4) x, y, z, w that turns z to the capsule's axis.
        length: (K,) [m] between the caps' centres.
        radius: (K,) [m].
    """

    start: Floats
    quaternion: Floats
    length: Floats
    radius: Floats


NOBODY: Final = Capsules(np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0), np.zeros(0))


def body_capsules(joints: Floats) -> Capsules:
    """Give limbs, trunk and head of a person as capsules, from its joints (17, 3) [m]."""
    ends = [
        (joints[a], joints[b], radius)
        for one, other, radius in _LIMBS
        for a, b in zip(one, other, strict=True)
    ]
    shoulders, hips = joints[list(_SHOULDERS)], joints[list(_HIPS)]
    head = joints[list(_EARS)].mean(axis=0)
    ends.append((shoulders[0], shoulders[1], _ACROSS_RADIUS))
    ends.append((hips[0], hips[1], _ACROSS_RADIUS))
    ends.append(
        (shoulders.mean(axis=0) + 0.18 * (hips - shoulders).mean(axis=0), hips.mean(axis=0), _TRUNK_RADIUS)
    )
    ends.append(
        (
            head + 0.12 * (shoulders.mean(axis=0) - head),
            head + 0.14 * (head - shoulders.mean(axis=0)),
            _HEAD_RADIUS,
        )
    )
    start, end = np.array([a for a, _, _ in ends]), np.array([b for _, b, _ in ends])
    axis = end - start
    length = np.linalg.norm(axis, axis=1)
    return Capsules(start, turn_z_to(axis), length, np.array([r for _, _, r in ends]) * _size(joints))


def turn_z_to(axis: Floats) -> Floats:
    """Find the shortest turns (K, 4) x, y, z, w from z to axes (K, 3); none for an axis of length 0."""
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    x, y, z = (axis / np.where(length > 0.0, length, 1.0)).T
    z = np.where(length[:, 0] > 0.0, z, 1.0)
    turns = np.stack([-y, x, np.zeros_like(x), 1.0 + z], axis=1)
    turns[z < -1.0 + 1e-9] = (1.0, 0.0, 0.0, 0.0)
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return turns


def _size(joints: Floats) -> float:
    """The height [m] that the person would have standing: legs, trunk and neck as far as the ears."""
    chain = [joints[list(pair)].mean(axis=0) for pair in (_ANKLES, _KNEES, _HIPS, _SHOULDERS, _EARS)]
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(chain)))
