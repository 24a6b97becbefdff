"""The shapes of a human body: overlapping capsules, spheres and boxes on the bones."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body import anthropometry as table
from peopleboy.sim.people.body.anthropometry import BodySize
from peopleboy.sim.people.body.skeleton import (
    ATLAS_HEIGHT,
    BONE_INDEX,
    LUMBAR_HEIGHT,
    NECK_HEIGHT,
    THORAX_HEIGHT,
    lateral,
    shoulder_half_breadth,
)
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind, Vector

SIDES = ("left", "right")
ARM_PARTS = tuple(f"{side}_{part}" for side in SIDES for part in ("upper_arm", "forearm", "hand"))
LEG_PARTS = tuple(f"{side}_{part}" for side in SIDES for part in ("thigh", "shin", "foot"))
TORSO_PARTS = ("chest", "abdomen", "pelvis")
HEAD_PARTS = ("head", "hair", "neck")
BAG_PART = "bag"
PHONE_PART = "phone"
FLOOR = "floor"
"""Name of the frame on the floor under a person, beside those of the bones."""
FRAME_INDEX: Final = {**BONE_INDEX, FLOOR: len(BONE_INDEX)}
BODY_PARTS = (*HEAD_PARTS, *TORSO_PARTS, *ARM_PARTS, *LEG_PARTS)

# A pattern on the chest is centred on its part's origin, so that origin is the middle of the chest.
_CHEST_CENTRE = 0.735


@dataclass(frozen=True, slots=True, kw_only=True)
class PartGeometry:
    """Shapes of one part, in the frame of a bone, or of the floor, shifted by `offset_m`."""

    bone: str
    shapes: tuple[Shape, ...]
    offset_m: Vector = (0.0, 0.0, 0.0)


def capsule(start: Vector, end: Vector, radius: float) -> Shape:
    """Make a capsule from the centres of its two caps [m]."""
    a, b = np.array(start), np.array(end)
    middle = (a + b) / 2.0
    length = float(np.linalg.norm(b - a))
    return Shape(
        kind=ShapeKind.CAPSULE,
        size=(length, radius, 0.0),
        position=(float(middle[0]), float(middle[1]), float(middle[2])),
        orientation=_turn_z_to((b - a) / length),
    )


def _turn_z_to(direction: NDArray[np.float64]) -> Quaternion:
    """Find the shortest rotation from z to a unit vector, as x, y, z, w."""
    x, y, z = (float(v) for v in direction)
    if z < -1.0 + 1e-12:
        return (1.0, 0.0, 0.0, 0.0)
    norm = math.sqrt(2.0 * (1.0 + z))
    return (-y / norm, x / norm, 0.0, norm / 2.0)


def sphere(centre: Vector, radius: float) -> Shape:
    """Make a sphere [m]."""
    return Shape(kind=ShapeKind.SPHERE, size=(radius, 0.0, 0.0), position=centre)


def box(centre: Vector, size: Vector) -> Shape:
    """Make a box of the given full extents [m]."""
    return Shape(kind=ShapeKind.BOX, size=size, position=centre)


def build_body(size: BodySize, hair: str, thickness_m: Mapping[str, float]) -> dict[str, PartGeometry]:
    """Make the parts of a body.

    Args:
        size: the sizes of the body.
        hair: "short", "long", "bald" or "cap".
        thickness_m: [m] distance of clothes from the skin, by part; 0 for parts that are missing.
    """
    parts = {**_head(size, hair), **_torso(size, thickness_m)}
    for side in SIDES:
        parts |= _arm(size, side, thickness_m)
        parts |= _leg(size, side, thickness_m)
    return {name: parts[name] for name in BODY_PARTS}


def _head(size: BodySize, hair: str) -> dict[str, PartGeometry]:
    """Make face, hair and neck: the crown of the hair at the stature, the chin at its tabulated height."""
    h, g = size.stature_m, size.girths
    crown = 1.0 - ATLAS_HEIGHT
    breadth = g.head_breadth / 2.0
    front = g.head_length / 2.0
    jaw = 0.029
    face = (
        capsule((0.0155 * h, 0.0, (crown - 0.060) * h), (0.0155 * h, 0.0, 0.020 * h), (front - 0.0155) * h),
        sphere((0.021 * h, 0.0, (table.CHIN_HEIGHT - ATLAS_HEIGHT + jaw) * h), jaw * h),
        capsule((front * h, 0.0, 0.030 * h), ((front + 0.006) * h, 0.0, 0.022 * h), 0.006 * h),
        *(sphere((-0.004 * h, lateral(s) * breadth * 0.92 * h, 0.030 * h), 0.0115 * h) for s in SIDES),
    )
    neck_radius = size.radius_of(g.neck_circumference) * 0.98
    neck_rise = ATLAS_HEIGHT - NECK_HEIGHT
    neck = capsule((-0.004 * h, 0.0, -0.015 * h), (0.008 * h, 0.0, (neck_rise + 0.01) * h), neck_radius)
    return {
        "head": PartGeometry(bone="head", shapes=face),
        "hair": PartGeometry(bone="head", shapes=_hair(h, breadth, front, crown, hair)),
        "neck": PartGeometry(bone="neck", shapes=(neck,)),
    }


def _hair(h: float, breadth: float, front: float, crown: float, hair: str) -> tuple[Shape, ...]:
    """Make the skull cap, and the hair or cap on it."""
    z = crown - breadth
    rim = front - breadth + 0.001 if hair == "cap" else 0.0035
    skull = capsule(((breadth - front) * h, 0.0, z * h), (rim * h, 0.0, z * h), breadth * h)
    nape = capsule((-0.017 * h, 0.0, z * h), (-0.017 * h, 0.0, 0.018 * h), (breadth - 0.007) * h)
    if hair == "long":
        return (skull, nape, *(strand(h, z, lateral(side)) for side in SIDES))
    if hair == "cap":
        peak = box(((front + 0.012) * h, 0.0, (z - 0.002) * h), (0.062 * h, 0.072 * h, 0.006 * h))
        return (skull, nape, peak)
    return (skull, nape)


def strand(h: float, z: float, side: float) -> Shape:
    """Make one of two locks of hair that fall to the shoulders from mid-height of the skull."""
    return capsule(
        (-0.020 * h, side * 0.018 * h, z * h), (-0.030 * h, side * 0.022 * h, -0.062 * h), 0.033 * h
    )


def _torso(size: BodySize, thickness_m: Mapping[str, float]) -> dict[str, PartGeometry]:
    return {
        "chest": _chest(size, thickness_m.get("chest", 0.0)),
        "abdomen": _abdomen(size, thickness_m.get("abdomen", 0.0)),
        "pelvis": _pelvis(size, thickness_m.get("pelvis", 0.0)),
    }


def _chest(size: BodySize, cloth: float) -> PartGeometry:
    """Make ribs, the edges of the back, and the slopes from neck to shoulder joints."""
    h, g = size.stature_m, size.girths
    joint_y = shoulder_half_breadth(size)
    shoulder_z = table.SHOULDER_HEIGHT - _CHEST_CENTRE
    radius = g.chest_depth / 2.0
    rib_y = max(g.chest_breadth / 2.0 - radius, 0.004) + 0.006
    low, high = THORAX_HEIGHT - 0.005 - _CHEST_CENTRE, 0.800 - radius - _CHEST_CENTRE
    shapes: list[Shape] = []
    for side in SIDES:
        y = lateral(side)
        slope = ((-0.008, y * 0.018, 0.084), (-0.002, y * (joint_y - 0.012), shoulder_z - 0.031))
        edge = ((-0.008, y * 0.058, -0.055), (-0.004, y * 0.078, 0.025))
        ribs = ((0.0, y * rib_y, low), (0.0, y * rib_y, high))
        for ends, thickness in ((slope, 0.028), (edge, 0.038), (ribs, radius)):
            shapes.append(capsule(_times(h, ends[0]), _times(h, ends[1]), thickness * h + cloth))
        joint = (0.0, y * joint_y, shoulder_z - 0.022)
        shapes.append(sphere(_times(h, joint), 0.024 * h + cloth))
        if size.sex == "female":
            shapes.append(sphere(_times(h, (radius - 0.030, y * 0.040, -0.012)), 0.043 * h + cloth))
    return PartGeometry(
        bone="chest", shapes=tuple(shapes), offset_m=(0.0, 0.0, (_CHEST_CENTRE - THORAX_HEIGHT) * h)
    )


def _times(scale: float, vector: Vector) -> Vector:
    return (scale * vector[0], scale * vector[1], scale * vector[2])


def _abdomen(size: BodySize, cloth: float) -> PartGeometry:
    """Make two upright capsules side by side, and one across at the hem of the top."""
    h, g = size.stature_m, size.girths
    radius = g.waist_depth / 2.0
    half = max(g.waist_breadth / 2.0 - radius, 0.004)
    low, high, hem = 0.61 - LUMBAR_HEIGHT, 0.665 - LUMBAR_HEIGHT, 0.597 - LUMBAR_HEIGHT
    sides = tuple(
        capsule((0.003 * h, y * half * h, low * h), (0.003 * h, y * half * h, high * h), radius * h + cloth)
        for y in (1.0, -1.0)
    )
    across = ((0.001 * h, -half * 1.02 * h, hem * h), (0.001 * h, half * 1.02 * h, hem * h))
    return PartGeometry(bone="abdomen", shapes=(*sides, capsule(*across, radius * 1.03 * h + cloth)))


def _pelvis(size: BodySize, cloth: float) -> PartGeometry:
    """Make the hips and the rim of the pelvis above them, both horizontal."""
    h, g = size.stature_m, size.girths
    radius = g.buttock_depth / 2.0 * 0.96
    half = g.hip_breadth / 2.0 - radius
    rim_radius = min(g.waist_depth, g.buttock_depth) / 2.0 * 0.94
    rim_half = (g.hip_breadth * 0.5 + g.waist_breadth * 0.5) / 2.0 - rim_radius
    hips = ((-0.006 * h, -half * h, 0.016 * h), (-0.006 * h, half * h, 0.016 * h))
    rim = ((-0.002 * h, -rim_half * h, 0.050 * h), (-0.002 * h, rim_half * h, 0.050 * h))
    return PartGeometry(
        bone="pelvis", shapes=(capsule(*hips, radius * h + cloth), capsule(*rim, rim_radius * h + cloth))
    )


def _arm(size: BodySize, side: str, thickness_m: Mapping[str, float]) -> dict[str, PartGeometry]:
    """Make upper arm, forearm and hand, each tapering; the upper arm's cap forms the shoulder."""
    h, g = size.stature_m, size.girths
    upper, fore, hand = (f"{side}_{name}" for name in ("upper_arm", "forearm", "hand"))
    biceps = size.radius_of(g.biceps_circumference)
    elbow = size.radius_of(g.forearm_circumference) * 0.94
    wrist = size.radius_of(g.wrist_circumference) * 1.05
    cloth, sleeve = thickness_m.get(upper, 0.0), thickness_m.get(fore, 0.0)
    length, reach = table.UPPER_ARM_LENGTH * h, table.FOREARM_LENGTH * h
    return {
        upper: PartGeometry(
            bone=upper,
            shapes=(
                capsule((0.0, 0.0, -biceps), (0.0, 0.0, -0.55 * length), biceps + cloth),
                capsule((0.0, 0.0, -0.4 * length), (0.0, 0.0, -length), elbow + cloth),
            ),
        ),
        fore: PartGeometry(
            bone=fore,
            shapes=(
                capsule((0.0, 0.0, 0.0), (0.0, 0.0, -0.45 * reach), elbow * 0.97 + sleeve),
                capsule((0.0, 0.0, -0.3 * reach), (0.0, 0.0, -reach), (wrist + elbow) / 2.3 + sleeve),
            ),
        ),
        hand: PartGeometry(
            bone=hand,
            shapes=(
                capsule((0.009 * h, 0.0, -0.005 * h), (0.008 * h, 0.0, -0.072 * h), 0.0145 * h),
                capsule((-0.008 * h, 0.0, -0.005 * h), (-0.005 * h, 0.0, -0.094 * h), 0.0140 * h),
            ),
        ),
    }


def _leg(size: BodySize, side: str, thickness_m: Mapping[str, float]) -> dict[str, PartGeometry]:
    """Make thigh, shin and foot; thigh and shin taper, the sole of the foot is flat."""
    h, g = size.stature_m, size.girths
    thigh, shin, foot = (f"{side}_{name}" for name in ("thigh", "shin", "foot"))
    length, shank = (table.HIP_HEIGHT - table.KNEE_HEIGHT) * h, (table.KNEE_HEIGHT - table.ANKLE_HEIGHT) * h
    top = size.radius_of(g.thigh_circumference) * 0.96
    knee = size.radius_of(g.lower_thigh_circumference)
    calf = size.radius_of(g.calf_circumference)
    ankle = size.radius_of(g.ankle_circumference)
    cloth, leg = thickness_m.get(thigh, 0.0), thickness_m.get(shin, 0.0)
    return {
        thigh: PartGeometry(
            bone=thigh,
            shapes=(
                capsule((0.0, 0.0, -0.01 * h), (0.0, 0.0, -0.42 * length), top + cloth),
                capsule(
                    (0.004 * h, 0.0, -0.3 * length), (0.0, 0.0, -0.80 * length), (top + 2 * knee) / 3 + cloth
                ),
                capsule((0.0, 0.0, -0.6 * length), (0.0, 0.0, -length), knee + cloth),
            ),
        ),
        shin: PartGeometry(
            bone=shin,
            shapes=(
                capsule((0.0, 0.0, 0.0), (-0.008 * h, 0.0, -0.40 * shank), calf * 0.97 + leg),
                capsule((-0.006 * h, 0.0, -0.3 * shank), (0.0, 0.0, -0.70 * shank), (calf + ankle) / 2 + leg),
                capsule((0.0, 0.0, -0.5 * shank), (0.0, 0.0, -shank), ankle + leg * 0.5),
            ),
        ),
        foot: PartGeometry(bone=foot, shapes=_foot(h)),
    }


def _foot(h: float) -> tuple[Shape, ...]:
    """Make a foot: a flat sole from heel to ball, rounded toes, and the instep below the shin."""
    sole = -table.ANKLE_HEIGHT * h
    points = sole_points(h)
    heel_x, ball_x, toe_x = (float(x) for x in points[:, 0])
    breadth = table.FOOT_BREADTH * h
    toe = 0.0165 * h
    return (
        box(((heel_x + ball_x) / 2, 0.0, sole + 0.011 * h), (ball_x - heel_x, breadth * 0.9, 0.022 * h)),
        capsule((toe_x, -breadth / 2 + toe, sole + toe), (toe_x, breadth / 2 - toe, sole + toe), toe),
        capsule((-0.010 * h, 0.0, -0.012 * h), (ball_x, 0.0, sole + 0.021 * h), 0.021 * h),
    )


def sole_points(stature_m: float) -> NDArray[np.float64]:
    """Return (3, 3) [m] heel, ball and toe in the foot's frame: the lowest points of a rolling foot."""
    h = stature_m
    heel, toe = -0.040 * h, (table.FOOT_LENGTH - 0.040 - 0.0165) * h
    sole = -table.ANKLE_HEIGHT * h
    return np.array([[heel, 0.0, sole], [0.070 * h, 0.0, sole], [toe, 0.0, sole]])


SUPPORTS: Final = (*("left_foot",) * 3, *("right_foot",) * 3, *("head", "chest", "pelvis") * 2)
"""The bone of each point of `support_points`."""


def support_points(size: BodySize) -> NDArray[np.float64]:
    """Return (12, 3) [m] points that a body may rest on, each in the frame of its bone in `SUPPORTS`.

    These are heel, ball and toe of both feet, then the back and the front of head, chest and pelvis.
    """
    h, g = size.stature_m, size.girths
    head, chest, pelvis = g.head_length / 2.0, g.chest_depth / 2.0, g.buttock_depth / 2.0
    ribs = _CHEST_CENTRE - THORAX_HEIGHT
    back = [(-head, 0.0, 0.030), (-chest, 0.0, ribs), (-pelvis, 0.0, 0.016)]
    front = [(-x, y, z) for x, y, z in back]
    soles = sole_points(h)
    return np.concatenate([soles, soles, h * np.array(back), h * np.array(front)])


def bag(side: str, stature_m: float) -> PartGeometry:
    """Make a briefcase that hangs from a hand."""
    drop = (table.HAND_LENGTH * 0.75) * stature_m
    return PartGeometry(bone=f"{side}_hand", shapes=(box((0.0, 0.0, -drop - 0.15), (0.38, 0.10, 0.28)),))


def phone(side: str, stature_m: float) -> PartGeometry:
    """Make a telephone that lies in a palm."""
    inward = -1.0 if side == "left" else 1.0
    centre = (0.0, 0.028 * inward, -0.6 * table.HAND_LENGTH * stature_m)
    return PartGeometry(bone=f"{side}_hand", shapes=(box(centre, (0.072, 0.009, 0.15)),))


def bone_index(parts: Mapping[str, PartGeometry]) -> NDArray[np.int64]:
    """Return the (P,) index in `FRAME_INDEX` of the frame that carries each part."""
    return np.array([FRAME_INDEX[part.bone] for part in parts.values()])
