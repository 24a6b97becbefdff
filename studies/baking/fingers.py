"""Relaxed hands: MakeHuman's body rests with spread and stretched fingers."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.skeleton import lateral
from peopleboy.studies.baking.makehuman import MakeHuman

Array = NDArray[np.float64]

_SPLAY_KEPT: Final = 0.15  # share of the angles between fingers that stays
_FLEXION_RAD: Final = (0.25, 0.35, 0.25)  # by which each of a finger's three bones is bent more
_THUMB_RAD: Final = 0.35  # by which the thumb is turned towards the fingers


class Fingers:
    """The finger bones of the rig `default` of the data, which has 163 bones."""

    def __init__(self, data: MakeHuman) -> None:
        self._data = data
        self._weights = data.weights("default")

    def relax(self, vertices: Array) -> Array:
        """Return a body (V, 3) with its fingers together and a little bent."""
        moved = vertices.copy()
        for side in SIDES:
            for finger, turns, joints in self._turns(side, vertices):
                origin = joints[0]
                for k in range(3):
                    share = self._weights[f"finger{finger}-{k + 1}.{side[0].upper()}"][:, None]
                    moved += share * ((vertices - joints[k]) @ turns[k].T + origin - vertices)
                    origin = origin + turns[k] @ (joints[k + 1] - joints[k])
        return moved

    def _turns(self, side: str, vertices: Array) -> Iterator[tuple[int, list[Array], list[Array]]]:
        """Yield each finger with the rotations (3, 3) of its three bones, and its four joints (3,)."""
        at = {
            finger: [self._data.joint(vertices, f"{side[0]}-finger-{finger}-{k}") for k in range(1, 5)]
            for finger in range(1, 6)
        }
        along = unit(at[3][2] - at[3][0])
        back = unit(np.cross(at[2][0] - at[5][0], along) * lateral(side))  # out of the back of the hand
        hinge = unit(np.cross(back, along))
        for finger, joints in at.items():
            way = joints[2] - joints[0]
            flat = unit(way - (way @ back) * back)
            splay = math.atan2(float(np.cross(flat, along) @ back), float(flat @ along))
            if finger == 1:
                thumb = turn_about(back, math.copysign(_THUMB_RAD, splay))
                yield finger, [thumb] * 3, joints
                continue
            turns = [turn_about(back, (1.0 - _SPLAY_KEPT) * splay)]
            for bend in _FLEXION_RAD:
                turns.append(turns[-1] @ turn_about(hinge, bend))
            yield finger, turns[1:], joints


def unit(vector: Array) -> Array:
    """Return a vector, scaled to a length of 1."""
    return np.asarray(vector / np.linalg.norm(vector))


def turn_about(axis: Array, angle: float) -> Array:
    """Return the (3, 3) rotation about a unit vector [rad]."""
    x, y, z = axis
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k)
