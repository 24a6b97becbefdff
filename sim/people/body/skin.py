"""The skin of one person, and what its movements and other cameras need to know of its body."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.anthropometry import BodySize
from peopleboy.sim.people.body.bodies import RestBody
from peopleboy.sim.people.body.body_shapes import (
    BAG_PART,
    BODY_PARTS,
    SIDES,
    PartGeometry,
    capsule,
    sphere,
)
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.garments import Garments
from peopleboy.sim.people.body.outfit import Outfit, carried_bag, headgear_shapes
from peopleboy.sim.people.body.skeleton import ATLAS_HEIGHT, BONE_INDEX, BONES, JOINT_NAMES, THORAX_HEIGHT
from peopleboy.sim.shapes.shapes import Shape, Vector
from peopleboy.sim.shapes.skins import Skin

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

_SOLE_M: Final = 0.02  # vertices within this height touch the floor
_ROUND_M: Final = 0.004  # capsules that are shorter are spheres


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BodyPlan:
    """Everything that a person gets from its body and clothes.

    Attributes:
        skin: the mesh, its parts numbered as in `geometry`; None for a person of capsules.
        geometry: shapes of all parts; with a skin, stand-ins and what is not part of the mesh.
        offsets: (17, 3) [m] as `skeleton.joint_offsets`.
        supports: (12, 3) [m] as `body_shapes.support_points`.
        joint_bone, joint_offset: as `skeleton.joint_points` returns them.
        arm_m: [m] as `body_placement.arm_lengths` returns them.
        head_m: [m] stature of the person to whose head the head's textures fit.
    """

    skin: Skin | None
    geometry: dict[str, PartGeometry]
    offsets: Array
    supports: Array
    joint_bone: Numbers
    joint_offset: Array
    arm_m: tuple[float, float]
    head_m: float


def dress_body(body: RestBody, size: BodySize, clothes: Clothes, outfit: Outfit) -> BodyPlan:
    """Put clothes on a body, and measure what the person's movements need."""
    garments = Garments(body, clothes, outfit, size.stature_m)
    vertices, triangles, label, rows = garments.worn()
    labels = list(body.mesh.labels)
    parts = [labels.index(name) for name in BODY_PARTS]
    number = np.argsort(parts)  # of each label among the parts
    geometry = _geometry(body, vertices, triangles, label)
    head_m = _head_stature(body)
    extras = headgear_shapes(replace(size, stature_m=head_m), outfit, clothes.hair)
    geometry["hair"] = replace(geometry["hair"], shapes=(*geometry["hair"].shapes, *extras))
    if outfit.carried != "nothing":
        geometry[BAG_PART] = _fitted(body, size, outfit)
    frames = np.zeros((len(BONES), 3, 4))
    for bone, name in enumerate(BONES):
        frames[bone, :, :3] = body.turns[bone]
        frames[bone, :, 3] = -body.turns[bone] @ body.joints[bone] - np.array(geometry[name].offset_m)
    skin = Skin(
        vertices=vertices,
        triangles=triangles,
        part=number[label],
        bones=body.mesh.bones[rows],
        weights=body.mesh.weights[rows],
        part_of_bone=np.array([BODY_PARTS.index(name) for name in BONES]),
        part_from_rest=frames,
    )
    joint_bone, joint_offset = _joints(body)
    return BodyPlan(
        skin=skin,
        geometry=geometry,
        offsets=body.offsets,
        supports=_supports(body, vertices, triangles, label),
        joint_bone=joint_bone,
        joint_offset=joint_offset,
        arm_m=_arm(body),
        head_m=head_m,
    )


def _fitted(body: RestBody, size: BodySize, outfit: Outfit) -> PartGeometry:
    """Return a bag; a rucksack lies on the back of this body."""
    made = carried_bag(size, outfit, 0.0)
    if outfit.carried != "rucksack":
        return made
    own = np.unique(body.mesh.triangles[body.mesh.label == body.mesh.labels.index("chest")])
    back = float(body.in_bone(BONE_INDEX["chest"], body.vertices[own])[:, 0].min())
    lower = THORAX_HEIGHT * size.stature_m - float(body.joints[BONE_INDEX["chest"], 2])
    return replace(made, offset_m=(back + size.girths.chest_depth / 2.0 * size.stature_m, 0.0, lower))


def _geometry(body: RestBody, vertices: Array, triangles: Numbers, label: Numbers) -> dict[str, PartGeometry]:
    """Return the stand-ins of all parts."""
    made = {}
    for name in BODY_PARTS:
        bone = "head" if name == "hair" else name
        own = np.unique(triangles[label == body.mesh.labels.index(name)])
        local = body.in_bone(BONE_INDEX[bone], vertices[own])
        offset: Vector = (0.0, 0.0, 0.0)
        if name == "chest":  # patterns are centred on the origin
            offset = (0.0, 0.0, float(local[:, 2].min() + local[:, 2].max()) / 2.0)
        made[name] = PartGeometry(bone=bone, shapes=_stand_in(local - np.array(offset)), offset_m=offset)
    return made


def _supports(body: RestBody, vertices: Array, triangles: Numbers, label: Numbers) -> Array:
    """Return the points that this body may rest on, as `support_points` does."""
    soles, back, front = _soles(body, vertices, triangles, label), [], []
    for name in ("head", "chest", "pelvis"):
        names = (name, "hair") if name == "head" else (name,)
        wanted = [body.mesh.labels.index(one) for one in names]
        own = np.unique(triangles[np.isin(label, wanted)])
        local = body.in_bone(BONE_INDEX[name], vertices[own])
        back.append(local[local[:, 0].argmin()])
        front.append(local[local[:, 0].argmax()])
    return np.concatenate([soles, soles, back, front])


def _soles(body: RestBody, vertices: Array, triangles: Numbers, label: Numbers) -> Array:
    """Return heel, ball and tip of both shoes in the foot's frame: the lowest points of a rolling foot."""
    feet = [
        body.in_bone(
            BONE_INDEX[f"{side}_foot"],
            vertices[np.unique(triangles[label == body.mesh.labels.index(f"{side}_foot")])],
        )
        for side in SIDES
    ]
    sole = min(float(foot[:, 2].min()) for foot in feet)
    low = np.concatenate([foot[foot[:, 2] < sole + _SOLE_M] for foot in feet])
    heel, tip = float(low[:, 0].min()), float(low[:, 0].max())
    ball = heel + 0.72 * (tip - heel)
    return np.array([[heel, 0.0, sole], [ball, 0.0, sole], [tip, 0.0, sole]])


def _arm(body: RestBody) -> tuple[float, float]:
    upper, fore, hand = (body.joints[BONE_INDEX[f"left_{bone}"]] for bone in ("upper_arm", "forearm", "hand"))
    label = body.mesh.labels.index("left_hand")
    own = body.in_bone(
        BONE_INDEX["left_hand"], body.vertices[np.unique(body.mesh.triangles[body.mesh.label == label])]
    )
    half_hand = 0.5 * -float(own[:, 2].min())
    return float(np.linalg.norm(fore - upper)), float(np.linalg.norm(hand - fore)) + half_hand


def _head_stature(body: RestBody) -> float:
    """Return the stature of the person to whose head today's hats and faces fit."""
    above = float(body.vertices[:, 2].max()) - float(body.joints[BONE_INDEX["head"], 2])
    return above / (1.0 - ATLAS_HEIGHT)


def _joints(body: RestBody) -> tuple[Numbers, Array]:
    """Return bone and place of each of `JOINT_NAMES`; limbs' joints are the starts of bones."""
    label = [body.mesh.labels.index(name) for name in ("head", "hair")]
    own = np.unique(body.mesh.triangles[np.isin(body.mesh.label, label[:1])])
    face, head = body.vertices[own], BONE_INDEX["head"]
    points = {
        "nose": face[face[:, 0].argmax()],
        "left_ear": face[face[:, 1].argmax()],
        "right_ear": face[face[:, 1].argmin()],
    }
    points |= {"left_eye": body.eyes[0], "right_eye": body.eyes[1]}
    starts = {
        "shoulder": "upper_arm",
        "elbow": "forearm",
        "wrist": "hand",
        "hip": "thigh",
        "knee": "shin",
        "ankle": "foot",
    }
    bones, offsets = [], []
    for name in JOINT_NAMES:
        side, _, joint = name.rpartition("_")
        if joint in starts:
            bones.append(BONE_INDEX[f"{side}_{starts[joint]}"])
            offsets.append(np.zeros(3))
        else:
            bones.append(head)
            offsets.append(body.in_bone(head, points[name]))
    return np.array(bones), np.array(offsets)


def _stand_in(points: Array) -> tuple[Shape, ...]:
    """Return two capsules that fill the box around points (N, 3) [m], or one where it is as wide as deep.

    They lie along the longest side of the box, next to each other along the second longest, with the
    shortest as diameter.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    thin, wide, long = np.argsort(half, kind="stable")
    radius = float(half[thin])
    shapes = []
    apart, reach = float(half[wide]) - radius, float(half[long]) - radius
    for sign in (1.0, -1.0) if apart > _ROUND_M else (0.0,):
        ends = np.stack([middle, middle])
        ends[:, wide] += sign * apart
        ends[0, long] -= reach
        ends[1, long] += reach
        start, end = (_tuple(point) for point in ends)
        one = capsule(start, end, radius) if 2.0 * reach > _ROUND_M else sphere(start, radius)
        shapes.append(replace(one, is_stand_in=True))
    return tuple(shapes)


def _tuple(point: Array) -> Vector:
    return float(point[0]), float(point[1]), float(point[2])
