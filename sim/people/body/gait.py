"""Gait: a motion-captured walking cycle, tabulated by stride length and phase, and its look-up."""

import functools
import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.manner import USUAL, Manner, bearing
from peopleboy.sim.people.body.skeleton import ARM_BONES, BONE_INDEX, BONES, lateral, standing_rotations

Array = NDArray[np.float64]

PHASES: Final = 48
AMPLITUDES: Final = np.array([0.0, 0.15, 0.3, 0.5, 0.75, 1.0, 1.2, 1.4])
_FULL_SPEED_M_S = 1.1  # speed at which a leg as long as the clip's makes the clip's stride


@njit(cache=True, nogil=True)
def amplitude_of(speed_m_s: float, root_scale: float) -> float:
    """Return the stride length relative to the clip's at a walking speed.

    `root_scale` is the root of the leg length relative to the clip's.

    The amplitude grows with the root of speed, as cadence does.
    """
    return min(math.sqrt(abs(speed_m_s) / (_FULL_SPEED_M_S * root_scale)), 1.4)


@njit(cache=True, nogil=True)
def gait_pose(
    rotations: Array, sway: Array, phase: float, amplitude: float, turns: Array
) -> tuple[float, float]:
    """Look a pose up in tables (A, P, 17, 3) and (A, P, 3) of `Gait`, at a phase [cycles].

    Returns:
        Offset of the pelvis [m] to the front and to the left; fills `turns` (17, 3) with rotation vectors.
    """
    last = len(AMPLITUDES) - 1
    i = last
    while i > 0 and amplitude < AMPLITUDES[i]:
        i -= 1
    row = float(i)
    if i < last:
        row = 1.0 / (AMPLITUDES[i + 1] - AMPLITUDES[i]) * (amplitude - AMPLITUDES[i]) + i
    column = (phase % 1.0) * PHASES
    i, j = min(int(row), last - 1), int(column) % PHASES
    di, dj, following = row - i, column - int(column), (j + 1) % PHASES
    turns[:] = 0.0
    front = left = 0.0
    for corner in range(4):
        a, p = i + corner // 2, following if corner % 2 else j
        weight = (di if corner // 2 else 1.0 - di) * (dj if corner % 2 else 1.0 - dj)
        front += weight * sway[a, p, 0]
        left += weight * sway[a, p, 1]
        for bone in range(turns.shape[0]):
            for axis in range(3):
                turns[bone, axis] += weight * rotations[a, p, bone, axis]
    return front, left


_CLIP = Path(__file__).with_name("walking_clip.json")
_HARMONICS = 5
# Thigh and shin of the clip's figure [m]: DeepMimic's humanoid.
CLIP_LEG_M = 0.421546 + 0.409870


@dataclass(frozen=True, slots=True, eq=False)
class WalkingClip:
    """One cycle of walking as Fourier series in the phase; phase 0 is about the right heel's strike.

    Attributes:
        rotations: (2K+1, 17, 3) [rad] coefficients of 1, cos, sin, cos 2, ... of the bones' rotation vectors.
        sway: (2K+1, 3) [m] the same for the pelvis' deviation from steady motion; x front, y left, z up.
        stride_m: [m] travel per cycle.
    """

    rotations: Array
    sway: Array
    stride_m: float


def fourier_basis(phase: Array) -> Array:
    """Return (..., 2K+1) the functions 1, cos, sin, cos 2, sin 2, ... at phases given in cycles."""
    angles = 2.0 * math.pi * np.asarray(phase)[..., None] * np.arange(1, _HARMONICS + 1)
    waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return np.concatenate([np.ones((*waves.shape[:-2], 1)), waves.reshape(*waves.shape[:-2], -1)], axis=-1)


@functools.cache
def load_walking_clip() -> WalkingClip:
    """Read the clip as five harmonics; tests fit them again.

    Source: humanoid3d_walk.txt of pybullet_data, which is DeepMimic's (Peng et al., 2018; MIT licence).
    """
    data = json.loads(_CLIP.read_text("utf-8"))
    rotations, sway = np.array(data["rotations"]), np.array(data["sway"])
    for array in (rotations, sway):
        array.setflags(write=False)
    return WalkingClip(rotations=rotations, sway=sway, stride_m=data["stride_m"])


# The left foot of the clip is on the floor between these phases [cycles].
_HEEL_STRIKE, _TOE_OFF = 0.485, 1.085
_FLAT_RAD = math.radians(3.0)
_MAX_REACH = 0.998  # [leg lengths] a walking knee is never fully straight
_STANDING_REACH = 0.9998
_LEAD = (
    0.055  # [cycles] lead of the body over the middle of its feet, chosen for the longest reach of the legs
)
_BOB = 0.7  # people rise and fall less in each step than they would on stiff legs
_LEAN = 0.5  # the clip's figure leans forward more than people do
# On one leg the hips shift over that leg, and the other hip drops.
_HIP_SHIFT, _HIP_DROP_RAD = 0.018, math.radians(5.0)


class Gait:
    """Poses of one body for every phase and stride length.

    The motion capture clip gives the movement of pelvis, trunk and arms and the pitch of the feet; its swing
    is scaled by an amplitude. The feet follow the floor: during stance the sole rolls from heel over the flat
    foot to the toe without slipping, between stances the clip's own path is bent to meet both ends (after
    Kovar, Schreiner and Gleicher 2002, Footskate cleanup for motion capture editing). Thighs and shins then
    follow by inverse kinematics.
    """

    def __init__(self, offsets: Array, soles: Array, stature_m: float, manner: Manner = USUAL) -> None:
        self._offsets, self._soles = offsets, soles
        self._manner, self._stature_m = manner, stature_m
        leg = -offsets[BONE_INDEX["left_shin"], 2] - offsets[BONE_INDEX["left_foot"], 2]
        self._scale = leg / CLIP_LEG_M
        self.root_scale = math.sqrt(self._scale)
        self.unit_stride_m = load_walking_clip().stride_m * self._scale * manner.stride

    def stride_m(self, amplitude: float) -> float:
        """Return the travel [m] per cycle."""
        return float(self.unit_stride_m * amplitude)

    def pose(self, phase: float, amplitude: float) -> tuple[Array, Array]:
        """Look up the pose at a phase [cycles].

        Returns:
            (17, 3) [rad] rotation vectors of the bones, and (2,) [m] offset of the pelvis from the person's
            steadily moving position, to the front and to the left.
        """
        turns = np.empty((len(BONES), 3))
        rotations, sway = self.tables
        return turns, np.array(gait_pose(rotations, sway, phase, amplitude, turns))

    def rebind(self, rotations: Array, sway: Array) -> None:
        """Use other arrays for the tables from now on; they must hold the same values already."""
        self.tables = rotations, sway

    @cached_property
    def tables(self) -> tuple[Array, Array]:
        """(A, P, 17, 3) and (A, P, 3) tables of all amplitudes, computed when a camera first needs them."""
        walks = [self._walk(float(amplitude)) for amplitude in AMPLITUDES]
        rotations = np.concatenate([rotations for rotations, _, _ in walks])
        pelvis = np.concatenate([pelvis for _, pelvis, _ in walks])
        for side in SIDES:
            ankle, pitch = (
                np.concatenate(each) for each in zip(*(feet[side] for *_, feet in walks), strict=True)
            )
            self._bend_leg(side, rotations, pelvis, ankle, pitch)
        shape = len(AMPLITUDES), PHASES
        return rotations.reshape(*shape, len(BONES), 3), pelvis.reshape(*shape, 3)

    def _walk(self, amplitude: float) -> tuple[Array, Array, dict[str, tuple[Array, Array]]]:
        """Compute a walk of one amplitude at every phase, legs aside.

        Returns:
            (P, 17, 3) rotation vectors, (P, 3) [m] pelvis offsets, and the feet as returned by `_foot_path`.
        """
        phases = np.arange(PHASES) / PHASES
        rotations = self._clip_rotations(phases, amplitude)
        sway = fourier_basis(phases) @ load_walking_clip().sway * self._scale * min(amplitude, 1.0)
        sway[:, 1] += max(1.0 - amplitude / 0.5, 0.0) * self._manner.leans * _HIP_SHIFT * self._stature_m
        feet = {side: self._foot_path(side, phases, amplitude) for side in SIDES}
        share = min(amplitude / 0.3, 1.0)
        reach = _STANDING_REACH + share * (_MAX_REACH - _STANDING_REACH)
        pelvis = np.column_stack([sway[:, :2], self._hip_height(rotations, sway, feet, reach)])
        return rotations, pelvis, feet

    def _clip_rotations(self, phases: Array, amplitude: float) -> Array:
        """Scale the clip's swing about its mean, and the mean towards standing; legs aside."""
        coefficients = load_walking_clip().rotations
        swing = np.tensordot(fourier_basis(phases)[:, 1:], coefficients[1:], axes=1)
        mean = coefficients[0].copy()
        mean[ARM_BONES, 0::2] *= self._manner.arm_spread
        mean[BONE_INDEX["pelvis"]] *= _LEAN
        share = min(amplitude / 0.5, 1.0)
        standing = standing_rotations()
        swing[:, ARM_BONES] *= self._manner.arm_swing
        rotations: Array = standing + share * (mean - standing) + min(amplitude, 1.1) * swing
        rotations += bearing(self._manner)
        drop = (1.0 - share) * self._manner.leans * _HIP_DROP_RAD
        rotations[:, [BONE_INDEX["pelvis"], BONE_INDEX["abdomen"]], 0] += drop, -1.3 * drop
        return rotations

    def _foot_path(self, side: str, phases: Array, amplitude: float) -> tuple[Array, Array]:
        """Return the path of the ankle and the pitch of the foot.

        Returns:
            (P, 3) [m] ankle in the person's frame, and (P,) [rad] pitch of the foot, toe down positive.
        """
        own = phases if side == "left" else phases + 0.5
        since_strike = (own - _HEEL_STRIKE) % 1.0
        stance = _TOE_OFF - _HEEL_STRIKE
        pitch = self._clip_pitch(own, amplitude)
        x, z = self._roll(since_strike, pitch, amplitude)
        swinging = since_strike > stance
        time = (since_strike[swinging] - stance) / (1.0 - stance)
        lift = np.sin(np.pi * time) * self._scale
        x[swinging] = self._swing(time, amplitude, axis=0)
        z[swinging] = np.maximum(
            self._swing(time, amplitude, axis=1) + 0.035 * min(amplitude, 1.2) * np.sin(np.pi * time) * lift,
            z[swinging] + 0.02 * min(amplitude / 0.5, 1.0) * lift,
        )
        manner, walks = self._manner, min(amplitude / 0.5, 1.0)
        hip_y = self._offsets[BONE_INDEX["left_thigh"], 1] * (manner.stance_width - manner.narrows * walks)
        x += 0.5 * (1.0 - walks) * lateral(side) * manner.stance_ahead * self._stature_m
        y = lateral(side) * (hip_y + math.sin(manner.toe_out_rad) * self._rolled(pitch))
        return np.stack([x, y, z], axis=-1), pitch

    def _clip_pitch(self, own: Array, amplitude: float) -> Array:
        """Return (P,) [rad] pitch of the clip's left foot at its own phases; small pitches count as flat."""
        coefficients = load_walking_clip().rotations
        chain = [BONE_INDEX[name] for name in ("pelvis", "left_thigh", "left_shin", "left_foot")]
        vectors = np.tensordot(fourier_basis(own), coefficients[:, chain], axes=1)
        pitch = vectors[..., 1].sum(axis=-1) * min(amplitude, 1.1)
        flat: Array = np.sign(pitch) * np.maximum(np.abs(pitch) - _FLAT_RAD, 0.0)
        return flat

    def _rolled(self, pitch: Array) -> Array:
        """Return how far the ankle has rolled forward [m] from its position over the flat foot."""
        forward: Array = self._pivot(pitch) * (1.0 - np.cos(pitch)) - self._soles[0, 2] * np.sin(pitch)
        return forward

    def _pivot(self, pitch: Array) -> Array:
        """Return the point along the sole [m] that touches the floor: toe or heel."""
        pivot: Array = np.where(pitch > 0.0, self._soles[2, 0], self._soles[0, 0])
        return pivot

    def _roll(self, since_strike: Array, pitch: Array, amplitude: float) -> tuple[Array, Array]:
        """Return ankle x, z [m] of a foot rolling on the floor, in the steadily moving frame."""
        middle = (_TOE_OFF - _HEEL_STRIKE) / 2.0 - _LEAD
        anchor = self.stride_m(amplitude) * (middle - since_strike)
        height = -self._soles[0, 2] * np.cos(pitch) + self._pivot(pitch) * np.sin(pitch)
        return anchor + math.cos(self._manner.toe_out_rad) * self._rolled(pitch), height

    def _swing(self, time: Array, amplitude: float, axis: int) -> Array:
        """Join the end of a stance (time 0) to the next (time 1) by a cubic of the same velocities."""
        stance, step = _TOE_OFF - _HEEL_STRIKE, 1e-3
        around = np.array([stance - step, stance, 0.0, step])
        pitch = self._clip_pitch(around + _HEEL_STRIKE, amplitude)
        before, start, finish, after = self._roll(around, pitch, amplitude)[axis]
        leave, arrive = np.array([start - before, after - finish]) / step * (1.0 - stance)
        t, rest = time, 1.0 - time
        ends = start * rest**2 * (1.0 + 2.0 * t) + finish * t**2 * (1.0 + 2.0 * rest)
        curve: Array = ends + leave * t * rest**2 - arrive * t**2 * rest
        return curve

    def _hip_height(
        self, rotations: Array, sway: Array, feet: dict[str, tuple[Array, Array]], reach: float
    ) -> Array:
        """Return (P,) [m] heights of the pelvis at which both legs reach their feet: a smooth curve."""
        from scipy.spatial.transform import Rotation  # here, as it is slow to import

        limits = []
        reach, turn = reach * self._leg_lengths().sum(), Rotation.from_rotvec(rotations[:, 0])
        for side in SIDES:
            hips = turn.apply(self._offsets[BONE_INDEX[f"{side}_thigh"]])
            gap = feet[side][0] - hips - sway * [1.0, 1.0, 0.0]
            limits.append(gap[:, 2] + np.sqrt(reach**2 - gap[:, 0] ** 2 - gap[:, 1] ** 2))
        limit = np.min(limits, axis=0)
        twice_a_cycle = fourier_basis(np.arange(PHASES) / PHASES)[:, [0, 3, 4]]
        # Least squares are projections here, as the columns are orthogonal over a whole cycle.
        fit = (twice_a_cycle * limit[:, None]).sum(axis=0) / np.square(twice_a_cycle).sum(axis=0)
        curve = twice_a_cycle @ (fit * [1.0, _BOB, _BOB])
        height: Array = curve - np.max(curve - limit)
        return height

    def _leg_lengths(self) -> Array:
        """Return (2,) [m] lengths of thigh and shin."""
        return -self._offsets[[BONE_INDEX["left_shin"], BONE_INDEX["left_foot"]], 2]

    def _bend_leg(self, side: str, rotations: Array, pelvis: Array, ankle: Array, pitch: Array) -> None:
        """Turn thigh, shin and foot so that the ankle meets its target (two-bone inverse kinematics)."""
        from scipy.spatial.transform import Rotation  # here, as it is slow to import

        thigh, shin = self._leg_lengths()
        hip_turn = Rotation.from_rotvec(rotations[:, 0])
        gap = ankle - pelvis - hip_turn.apply(self._offsets[BONE_INDEX[f"{side}_thigh"]])
        distance = np.minimum(np.linalg.norm(gap, axis=1), thigh + shin - 1e-6)
        knee = np.arccos(np.clip((distance**2 - thigh**2 - shin**2) / (2.0 * thigh * shin), -1.0, 1.0))
        before_knee = np.arctan2(shin * np.sin(knee), thigh + shin * np.cos(knee))
        yaw = lateral(side) * self._manner.toe_out_rad
        across = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
        up = -gap / np.linalg.norm(gap, axis=1, keepdims=True)
        front = np.cross(across, up)
        front /= np.linalg.norm(front, axis=1, keepdims=True)
        leg = Rotation.from_matrix(np.stack([front, np.cross(up, front), up], axis=-1))
        about_y = np.array([0.0, 1.0, 0.0])
        thigh_turn = leg * Rotation.from_rotvec(-before_knee[:, None] * about_y)
        shin_turn = Rotation.from_rotvec(knee[:, None] * about_y)
        foot = Rotation.from_euler("ZY", np.stack([np.full_like(pitch, yaw), pitch], axis=-1))
        rotations[:, BONE_INDEX[f"{side}_thigh"]] = (hip_turn.inv() * thigh_turn).as_rotvec()
        rotations[:, BONE_INDEX[f"{side}_shin"]] = shin_turn.as_rotvec()
        rotations[:, BONE_INDEX[f"{side}_foot"]] = ((thigh_turn * shin_turn).inv() * foot).as_rotvec()
