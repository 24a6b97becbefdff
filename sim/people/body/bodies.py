"""Bodies of skinned people: meshes of many people by age, sex and build, and the choice of one of them."""

import functools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.anthropometry import Build, Sex
from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES, PARENT_INDEX

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Age = Literal["child", "adult", "elder"]

_FILE: Final = Path(__file__).with_name("bodies.npz")
_STEP_M: Final = 1e-4  # unit of lengths in the file
_WEIGHTS: Final = 255.0  # sum of a vertex's weights in the file
# Weight factors of the file that are nearest to each build, and the stature [m] that counts as much as a
# difference of 1 in them.
_BUILD_WEIGHT: Final[dict[Build, float]] = {"slim": 0.25, "average": 0.5, "stout": 0.85}
_STATURE_M: Final = 0.5
_CHOICES: Final = 2  # nearest bodies among which chance decides
# Joints of the file after the starts of the bones.
_HAND_ENDS, _EYES = (len(BONES), len(BONES) + 1), (len(BONES) + 2, len(BONES) + 3)
# A limb is turned at rest, so that it hangs: each bone with the joint that it leads to.
_LEADS_TO: Final = {
    BONE_INDEX[f"{side}_{bone}"]: _HAND_ENDS[k] if onto is None else BONE_INDEX[f"{side}_{onto}"]
    for k, side in enumerate(("left", "right"))
    for bone, onto in (
        ("upper_arm", "forearm"), ("forearm", "hand"), ("hand", None), ("thigh", "shin"), ("shin", "foot"),
    )
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BodyMesh:
    """The mesh that all bodies share.

    Attributes:
        triangles: (T, 3) corners, counterclockwise from outside.
        label: (T,) index into `labels` of each triangle.
        labels: names of parts: those of the bones, and "hair".
        bones: (V, 4) bones that move each vertex.
        weights: (V, 4) their shares, which sum to 1.
    """

    triangles: Numbers
    label: Numbers
    labels: tuple[str, ...]
    bones: Numbers
    weights: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RestBody:
    """The body of one person at rest: standing, the arms half raised.

    Attributes:
        mesh: see `BodyMesh`.
        vertices: (V, 3) [m].
        joints: (17, 3) [m] starts of the bones.
        eyes: (2, 3) [m] left and right.
        turns: (17, 3, 3) rotations from rest to the upright posture with hanging arms.
        offsets: (17, 3) [m] each bone's joint in its parent's frame in that posture, the pelvis at 0.
    """

    mesh: BodyMesh
    vertices: Array
    joints: Array
    eyes: Array
    turns: Array
    offsets: Array

    def in_bone(self, bone: int, points: Array) -> Array:
        """Convert points (..., 3) at rest to the frame of a bone."""
        turned: Array = (points - self.joints[bone]) @ self.turns[bone].T
        return turned


@dataclass(frozen=True, slots=True, eq=False)
class _File:
    mesh: BodyMesh
    vertices: NDArray[np.int16]
    joints: NDArray[np.int16]
    age: NDArray[np.str_]
    sex: NDArray[np.str_]
    weight: Array
    stature_m: Array


@functools.cache
def _load() -> _File:
    """Read the file that `studies.baking.bake_bodies` writes."""
    with np.load(_FILE, allow_pickle=False) as data:
        mesh = BodyMesh(
            triangles=data["triangles"].astype(np.int64),
            label=data["part"].astype(np.int64),
            labels=tuple(data["parts"].tolist()),
            bones=data["bones"].astype(np.int64),
            weights=data["weights"] / _WEIGHTS,
        )
        vertices = data["vertices"]
        stature_m = vertices[:, :, 2].max(axis=1) * _STEP_M
        return _File(
            mesh,
            vertices,
            data["joints"],
            data["age"],
            data["sex"],
            data["weight"].astype(np.float64),
            stature_m,
        )


def choose_body(age: Age, sex: Sex, build: Build, stature_m: float, rng: np.random.Generator) -> RestBody:
    """Return a body that suits a person, scaled to a stature [m]; chance picks one of the two nearest."""
    file = _load()
    away = np.abs(file.stature_m - stature_m) / _STATURE_M + np.abs(file.weight - _BUILD_WEIGHT[build])
    away[(file.age != age) | (file.sex != sex)] = math.inf
    number = int(np.argsort(away, kind="stable")[int(rng.integers(_CHOICES))])
    scale = _STEP_M * stature_m / file.stature_m[number]
    return make_body(file.mesh, scale * file.vertices[number], scale * file.joints[number])


def make_body(mesh: BodyMesh, vertices: Array, joints: Array) -> RestBody:
    """Return a body from vertices (V, 3) and the joints (21, 3) of the file [m]."""
    turns, offsets = np.tile(np.eye(3), (len(BONES), 1, 1)), np.zeros((len(BONES), 3))
    for bone in range(len(BONES)):
        if bone in _LEADS_TO:
            turns[bone] = _hanging(joints[_LEADS_TO[bone]] - joints[bone])
        parent = PARENT_INDEX[bone]
        if parent >= 0:
            offsets[bone] = turns[parent] @ (joints[bone] - joints[parent])
    return RestBody(
        mesh=mesh, vertices=vertices, joints=joints[: len(BONES)], eyes=joints[list(_EYES)], turns=turns,
        offsets=offsets,
    )  # fmt: skip


def _hanging(direction: Array) -> Array:
    """Return the shortest rotation (3, 3) of a direction onto -z."""
    x, y, z = direction / np.linalg.norm(direction)
    # The axis is direction x (0, 0, -1); its length is the sine, -z the cosine.
    axis = np.array([-y, x, 0.0])
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    turn: Array = np.eye(3) + cross + cross @ cross / (1.0 - z)
    return turn
