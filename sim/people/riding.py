"""Poses of people who ride: in a wheelchair, or on a bicycle whose pedals turn with the way."""

import math
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_placement import turn_arm
from peopleboy.sim.people.body.body_shapes import SIDES, SUPPORTS
from peopleboy.sim.people.body.postures import standing_rotations
from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES, PARENT_INDEX, chain, lateral
from peopleboy.sim.people.equipment import SEAT_M, Equipment, bicycle_size
from peopleboy.sim.people.motion.gait import AMPLITUDES, Gait
from peopleboy.sim.people.motion.steps import PHASES, bend_leg, leg_lengths

Array = NDArray[np.float64]

_REST_M: Final = 0.12  # height of the foot rests
_BUTTOCK: Final = 0.05  # [statures] height of the hip joints above a seat
_RIM_M: Final = (0.02, 0.29, 0.56)  # where the left hand is at its wheel, from below the hips
_LEAN_RAD: Final = {"wheelchair": math.radians(-4.0), "bicycle": math.radians(24.0)}
_PER_TURN_M: Final = 2.8  # travel of a bicycle per turn of its cranks, at 1.1 m/s and more at higher speeds
_FOOT_RAD: Final = math.radians(12.0)  # pitch of the feet on pedals, toe down


def riding_gait(
    kind: Equipment, offsets: Array, arm_m: tuple[float, float], sole_m: float, stature_m: float
) -> Gait:
    """Return the poses of a person who rides.

    Args:
        kind: one of `RIDDEN`.
        offsets: (17, 3) [m] as returned by `joint_offsets`.
        arm_m: [m] as returned by `arm_lengths`.
        sole_m: [m] height of the ankle above the sole.
        stature_m: [m].
    """
    tables = partial(_riding_tables, kind, offsets, arm_m, sole_m, stature_m)
    return Gait(root_scale=1.0, unit_stride_m=_PER_TURN_M, make_tables=tables)


def _riding_tables(
    kind: Equipment, offsets: Array, arm_m: tuple[float, float], sole_m: float, stature_m: float
) -> tuple[Array, Array]:
    rotations = _poses(kind, offsets, arm_m, sole_m, stature_m)
    shape = len(AMPLITUDES), PHASES, len(BONES), 3
    return np.broadcast_to(rotations, shape).copy(), np.zeros((*shape[:2], 3))


def riding_supports(kind: Equipment, stature_m: float) -> Array:
    """Return (12, 3) [m] points in place of `support_points`: the lowest is on the floor below the hips."""
    below = np.zeros((len(SUPPORTS), 3))
    lean = _LEAN_RAD[kind]
    down = hips_m(kind, stature_m) * np.array([math.sin(lean), 0.0, -math.cos(lean)])
    below[[bone == "pelvis" for bone in SUPPORTS]] = down
    return below


def hips_m(kind: Equipment, stature_m: float) -> float:
    """Return the height of the hip joints [m] above the floor."""
    if kind == "bicycle":
        return bicycle_size(stature_m).hips_z
    return SEAT_M + _BUTTOCK * stature_m


def _poses(
    kind: Equipment, offsets: Array, arm_m: tuple[float, float], sole_m: float, stature_m: float
) -> Array:
    """Return (P, 17, 3) [rad] rotation vectors by phase."""
    rotations = np.repeat(standing_rotations()[None], PHASES, axis=0)
    rotations[:, BONE_INDEX["pelvis"], 1] = _LEAN_RAD[kind]
    if kind == "bicycle":
        rotations[:, [BONE_INDEX["abdomen"], BONE_INDEX["chest"]], 1] = math.radians(7.0)
        rotations[:, [BONE_INDEX["neck"], BONE_INDEX["head"]], 1] = math.radians(-17.0)
    pelvis = np.zeros((PHASES, 3))
    pelvis[:, 2] = hips_m(kind, stature_m)
    for side in SIDES:
        ankle, pitch = (
            _pedalled(side, sole_m, stature_m)
            if kind == "bicycle"
            else _rested(side, offsets, sole_m, stature_m)
        )
        bend_leg(side, offsets, rotations, pelvis, ankle, pitch, toe_out_rad=0.0)
        for row in rotations:
            row[:] = _hand_at(row, side, _hold_m(kind, side, stature_m), offsets, arm_m, pelvis[0])
    return rotations


def _pedalled(side: str, sole_m: float, stature_m: float) -> tuple[Array, Array]:
    """Return the (P, 3) [m] ankle above its pedal, and the (P,) [rad] pitch of the foot."""
    size = bicycle_size(stature_m)
    turn = math.tau * (np.arange(PHASES) / PHASES + (0.0 if side == "left" else 0.5))
    ahead, up = size.arm * np.sin(turn), size.arm * np.cos(turn)
    ball = 0.07 * stature_m  # from the ankle to the ball of the foot, which is on the pedal
    x = size.crank[0] + ahead - ball * math.cos(_FOOT_RAD) + sole_m * math.sin(_FOOT_RAD)
    z = size.crank[1] + 0.02 + up + ball * math.sin(_FOOT_RAD) + sole_m * math.cos(_FOOT_RAD)
    ankle = np.stack([x, np.full(PHASES, lateral(side) * 0.10), z], axis=-1)
    return ankle, np.full(PHASES, _FOOT_RAD)


def _rested(side: str, offsets: Array, sole_m: float, stature_m: float) -> tuple[Array, Array]:
    """Return the (P, 3) [m] ankle above a foot rest, or below the knee if the leg is too short for it."""
    thigh, shin = leg_lengths(offsets)
    hips = hips_m("wheelchair", stature_m)
    drop = min(hips - _REST_M - sole_m, 0.97 * shin)
    x = 0.99 * thigh + math.sqrt(shin**2 - drop**2)
    ankle = np.array([x, lateral(side) * 0.09, hips - drop])
    return np.repeat(ankle[None], PHASES, axis=0), np.zeros(PHASES)


def _hold_m(kind: Equipment, side: str, stature_m: float) -> tuple[float, float, float]:
    """Return x, y, z [m] of a palm in the person's frame."""
    if kind == "bicycle":
        x, z = bicycle_size(stature_m).bar
        return x, lateral(side) * 0.23, z + 0.02
    x, y, z = _RIM_M
    return x, lateral(side) * y, z


def _hand_at(
    rotations: Array,
    side: str,
    palm_m: tuple[float, float, float],
    offsets: Array,
    arm_m: tuple[float, float],
    pelvis: Array,
) -> Array:
    """Turn an arm of (17, 3) rotations so that its palm is at a point of the person's frame."""
    own = offsets.copy()
    own[0] = pelvis
    bones = chain(rotations, own, PARENT_INDEX)
    chest, shoulder = bones[BONE_INDEX["chest"]], bones[BONE_INDEX[f"{side}_upper_arm"], :3, 3]
    return turn_arm(rotations, side, chest[:3, :3].T @ (np.array(palm_m) - shoulder), arm_m)
