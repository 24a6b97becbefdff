"""Steps: one cycle of walking or running of a body, from a motion clip and from where its feet must be."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.postures import standing_rotations
from peopleboy.sim.people.body.skeleton import ARM_BONES, BONE_INDEX, lateral
from peopleboy.sim.people.motion.manner import Manner, bearing
from peopleboy.sim.people.motion.motion_clips import CLIP_LEG_M, MotionClip, fourier_basis

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PHASES: Final = 48
RUNNING_AMPLITUDE: Final = 1.2
"""Stride length, relative to the clip's, from which people who run do so: from 1.6 m/s on."""

_STANDING_REACH = 0.9998
# On one leg the hips shift over that leg, and the other hip drops.
_HIP_SHIFT, _HIP_DROP_RAD = 0.018, math.radians(5.0)
_RUNNING_SWING = 0.8  # share of the movement of a runner at 3.6 m/s, for speeds up to 2.5 m/s


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cycle:
    """One cycle at P phases.

    Attributes:
        rotations: (P, 17, 3) [rad] rotation vectors of the bones; those of legs are not valid yet.
        pelvis_m: (P, 3) offset of the pelvis in the person's frame.
        ankle_m, pitch_rad: by side, (P, 3) ankle in the person's frame, and (P,) pitch of the foot, toe down
            positive.
        lift_m: (P,) height of the lowest sole above the floor.
    """

    rotations: Array
    pelvis_m: Array
    ankle_m: Mapping[str, Array]
    pitch_rad: Mapping[str, Array]
    lift_m: Array


class Steps:
    """Cycles of one body with the movement of one clip.

    The clip gives the movement of pelvis, trunk and arms and the pitch of the feet; its swing is scaled by an
    amplitude. The feet follow the floor: during stance the sole rolls from heel over the flat foot to the toe
    without slipping, between stances the clip's own path is bent to meet both ends (after Kovar, Schreiner
    and Gleicher 2002, Footskate cleanup for motion capture editing). Thighs and shins then follow by inverse
    kinematics.

    Args:
        offsets, soles, stature_m, manner: as for `Gait`.
        clip: the motion clip.
    """

    def __init__(
        self, offsets: Array, soles: Array, stature_m: float, manner: Manner, clip: MotionClip
    ) -> None:
        self._offsets, self._soles = offsets, soles
        self._stature_m, self._manner, self._clip = stature_m, manner, clip
        self.scale = float(leg_lengths(offsets).sum()) / CLIP_LEG_M
        self._stance = clip.toe_off - clip.heel_strike

    def walk(self, amplitude: float, stride_m: float) -> Cycle:
        """Compute a walking cycle of one amplitude and stride length."""
        phases, clip = np.arange(PHASES) / PHASES, self._clip
        rotations = self._clip_rotations(phases, amplitude)
        sway = fourier_basis(phases) @ clip.sway * self.scale * min(amplitude, 1.0)
        sway[:, 1] *= self._manner.sways
        sway[:, 1] += max(1.0 - amplitude / 0.5, 0.0) * self._manner.leans * _HIP_SHIFT * self._stature_m
        feet = {side: self._walking_foot(side, phases, amplitude, stride_m) for side in SIDES}
        share = min(amplitude / 0.3, 1.0)
        reach = _STANDING_REACH + share * (clip.reach - self._manner.bent_knees - _STANDING_REACH)
        limit = self._highest_hip(rotations, sway, {side: foot[0] for side, foot in feet.items()}, reach)
        return Cycle(
            rotations=rotations,
            pelvis_m=np.column_stack([sway[:, :2], self._smooth_height(limit)]),
            ankle_m={side: foot[0] for side, foot in feet.items()},
            pitch_rad={side: foot[1] for side, foot in feet.items()},
            lift_m=np.zeros(PHASES),
        )

    def run(self, amplitude: float, stride_m: float) -> Cycle:
        """Compute a running cycle: both feet leave the floor between stances."""
        phases, clip = np.arange(PHASES) / PHASES, self._clip
        rotations = self._clip_rotations(phases, _RUNNING_SWING)
        sway = fourier_basis(phases) @ clip.sway * self.scale * [1.0, self._manner.sways, clip.bob]
        pitch, ankle, is_down = {}, {}, {}
        for side in SIDES:
            since_strike = self._since_strike(side, phases)
            pitch[side] = self._clip_pitch(self._own_phase(side, phases), _RUNNING_SWING)
            ankle[side] = self._on_floor(side, since_strike, pitch[side], amplitude, stride_m)
            is_down[side] = since_strike <= self._stance
        limit = self._highest_hip(rotations, sway, ankle, clip.reach, is_down)
        pelvis = sway + np.array([0.0, 0.0, np.min(limit - sway[:, 2])])
        for side in SIDES:
            self._swing_over(side, phases, rotations, pelvis, ankle[side], is_down[side])
        lowest = np.min([ankle[side][:, 2] + self._sole_drop(pitch[side]) for side in SIDES], axis=0)
        is_flying = ~(is_down["left"] | is_down["right"])
        lift = np.where(is_flying, np.maximum(lowest, 0.0), 0.0)
        return Cycle(rotations=rotations, pelvis_m=pelvis, ankle_m=ankle, pitch_rad=pitch, lift_m=lift)

    def _clip_rotations(self, phases: Array, amplitude: float) -> Array:
        """Scale the clip's swing about its mean, and the mean towards standing; legs aside."""
        coefficients = self._clip.rotations
        swing = np.tensordot(fourier_basis(phases)[:, 1:], coefficients[1:], axes=1)
        mean = coefficients[0].copy()
        mean[ARM_BONES, 0::2] *= self._manner.arm_spread
        mean[BONE_INDEX["pelvis"]] *= self._clip.lean
        share = min(amplitude / 0.5, 1.0)
        standing = standing_rotations()
        swing[:, ARM_BONES] *= self._manner.arm_swing
        rotations: Array = standing + share * (mean - standing) + min(amplitude, 1.1) * swing
        rotations += bearing(self._manner)
        drop = (1.0 - share) * self._manner.leans * _HIP_DROP_RAD
        rotations[:, [BONE_INDEX["pelvis"], BONE_INDEX["abdomen"]], 0] += drop, -1.3 * drop
        return rotations

    @staticmethod
    def _own_phase(side: str, phases: Array) -> Array:
        return phases if side == "left" else phases + 0.5

    def _since_strike(self, side: str, phases: Array) -> Array:
        return (self._own_phase(side, phases) - self._clip.heel_strike) % 1.0

    def _walking_foot(
        self, side: str, phases: Array, amplitude: float, stride_m: float
    ) -> tuple[Array, Array]:
        """Return the path of the ankle and the pitch of the foot.

        Returns:
            (P, 3) [m] ankle in the person's frame, and (P,) [rad] pitch of the foot, toe down positive.
        """
        since_strike = self._since_strike(side, phases)
        pitch = self._clip_pitch(self._own_phase(side, phases), amplitude)
        ankle = self._on_floor(side, since_strike, pitch, amplitude, stride_m)
        swinging = since_strike > self._stance
        time = (since_strike[swinging] - self._stance) / (1.0 - self._stance)
        lift = np.sin(np.pi * time) * self.scale * self._manner.clearance
        x, z = (self._swing(time, amplitude, stride_m, axis) for axis in range(2))
        ankle[swinging, 0] = x + self._ahead_m(side, amplitude)
        ankle[swinging, 2] = np.maximum(
            z + 0.035 * min(amplitude, 1.2) * np.sin(np.pi * time) * lift,
            ankle[swinging, 2] + 0.02 * min(amplitude / 0.5, 1.0) * lift,
        )
        return ankle, pitch

    def _on_floor(
        self, side: str, since_strike: Array, pitch: Array, amplitude: float, stride_m: float
    ) -> Array:
        """Return the (P, 3) [m] path of the ankle of a foot that never leaves the floor."""
        manner, walks = self._manner, min(amplitude / 0.5, 1.0)
        x, z = self._roll(since_strike, pitch, stride_m)
        hip_y = self._offsets[BONE_INDEX["left_thigh"], 1] * (manner.stance_width - manner.narrows * walks)
        x += self._ahead_m(side, amplitude)
        y = lateral(side) * (hip_y + math.sin(manner.toe_out_rad) * self._rolled(pitch))
        return np.stack([x, y, z], axis=-1)

    def _ahead_m(self, side: str, amplitude: float) -> float:
        rests = 0.5 * (1.0 - min(amplitude / 0.5, 1.0))
        return rests * lateral(side) * self._manner.stance_ahead * self._stature_m

    def _clip_pitch(self, own: Array, amplitude: float) -> Array:
        """Return (P,) [rad] pitch of the clip's left foot at its own phases; small pitches count as flat."""
        chain = [BONE_INDEX[name] for name in ("pelvis", "left_thigh", "left_shin", "left_foot")]
        vectors = np.tensordot(fourier_basis(own), self._clip.rotations[:, chain], axes=1)
        pitch = vectors[..., 1].sum(axis=-1) * min(amplitude, 1.1)
        flat: Array = np.sign(pitch) * np.maximum(np.abs(pitch) - self._clip.flat_rad, 0.0)
        return flat

    def _rolled(self, pitch: Array) -> Array:
        """Return how far the ankle has rolled forward [m] from its position over the flat foot."""
        forward: Array = self._pivot(pitch) * (1.0 - np.cos(pitch)) - self._soles[0, 2] * np.sin(pitch)
        return forward

    def _pivot(self, pitch: Array) -> Array:
        """Return the point along the sole [m] that touches the floor: toe or heel."""
        pivot: Array = np.where(pitch > 0.0, self._soles[2, 0], self._soles[0, 0])
        return pivot

    def _sole_drop(self, pitch: Array) -> Array:
        """Return the height [m], negative, of the lowest point of the sole from the ankle."""
        drop: Array = self._soles[0, 2] * np.cos(pitch) - self._pivot(pitch) * np.sin(pitch)
        return drop

    def _roll(self, since_strike: Array, pitch: Array, stride_m: float) -> tuple[Array, Array]:
        """Return ankle x, z [m] of a foot rolling on the floor, in the steadily moving frame."""
        middle = self._stance / 2.0 - self._clip.lead
        anchor = stride_m * (middle - since_strike)
        return anchor + math.cos(self._manner.toe_out_rad) * self._rolled(pitch), -self._sole_drop(pitch)

    def _swing(self, time: Array, amplitude: float, stride_m: float, axis: int) -> Array:
        """Join the end of a stance (time 0) to the next (time 1) by a cubic of the same velocities."""
        stance, step = self._stance, 1e-3
        around = np.array([stance - step, stance, 0.0, step])
        pitch = self._clip_pitch(around + self._clip.heel_strike, amplitude)
        before, start, finish, after = self._roll(around, pitch, stride_m)[axis]
        leave, arrive = np.array([start - before, after - finish]) / step * (1.0 - stance)
        t, rest = time, 1.0 - time
        ends = start * rest**2 * (1.0 + 2.0 * t) + finish * t**2 * (1.0 + 2.0 * rest)
        curve: Array = ends + leave * t * rest**2 - arrive * t**2 * rest
        return curve

    def _swing_over(
        self, side: str, phases: Array, rotations: Array, pelvis: Array, ankle: Array, is_down: Flags
    ) -> None:
        """Replace the ankle's path between stances by the clip's, bent to meet both ends (P, 3) [m]."""
        from scipy.spatial.transform import Rotation  # here, as it is slow to import

        thigh, shin = leg_lengths(self._offsets)
        hip = Rotation.from_rotvec(rotations[:, 0])
        upper = hip * Rotation.from_rotvec(rotations[:, BONE_INDEX[f"{side}_thigh"]])
        lower = upper * Rotation.from_rotvec(rotations[:, BONE_INDEX[f"{side}_shin"]])
        own = pelvis + hip.apply(self._offsets[BONE_INDEX[f"{side}_thigh"]])
        own = own + upper.apply([0.0, 0.0, -thigh]) + lower.apply([0.0, 0.0, -shin])
        apart = ankle - own
        order = np.argsort(self._since_strike(side, phases), kind="stable")
        down = is_down[order].sum()
        last, first = order[down - 1], order[0]
        swing = order[down:]
        share = np.arange(1, len(swing) + 1) / (len(swing) + 1)
        eased = (share * share * (3.0 - 2.0 * share))[:, None]
        ankle[swing] = own[swing] + (1.0 - eased) * apart[last] + eased * apart[first]

    def _highest_hip(
        self,
        rotations: Array,
        sway: Array,
        ankle: Mapping[str, Array],
        reach: float,
        is_down: Mapping[str, Flags] | None = None,
    ) -> Array:
        """Return (P,) [m] greatest heights of the pelvis at which both legs, or those on the floor, reach."""
        from scipy.spatial.transform import Rotation  # here, as it is slow to import

        limits = []
        reach, turn = reach * leg_lengths(self._offsets).sum(), Rotation.from_rotvec(rotations[:, 0])
        for side in SIDES:
            hips = turn.apply(self._offsets[BONE_INDEX[f"{side}_thigh"]])
            gap = ankle[side] - hips - sway * [1.0, 1.0, 0.0]
            limit = gap[:, 2] + np.sqrt(np.maximum(reach**2 - gap[:, 0] ** 2 - gap[:, 1] ** 2, 0.0))
            limits.append(limit if is_down is None else np.where(is_down[side], limit, np.inf))
        highest: Array = np.min(limits, axis=0)
        return highest

    def _smooth_height(self, limit: Array) -> Array:
        """Return (P,) [m] heights of the pelvis, a smooth curve below its limit."""
        twice_a_cycle = fourier_basis(np.arange(PHASES) / PHASES)[:, [0, 3, 4]]
        # Least squares are projections here, as the columns are orthogonal over a whole cycle.
        fit = (twice_a_cycle * limit[:, None]).sum(axis=0) / np.square(twice_a_cycle).sum(axis=0)
        curve = twice_a_cycle @ (fit * [1.0, self._clip.bob, self._clip.bob])
        height: Array = curve - np.max(curve - limit)
        return height


def leg_lengths(offsets: Array) -> Array:
    """Return (2,) [m] lengths of thigh and shin."""
    return -offsets[[BONE_INDEX["left_shin"], BONE_INDEX["left_foot"]], 2]


def bend_leg(
    side: str,
    offsets: Array,
    rotations: Array,
    pelvis: Array,
    ankle: Array,
    pitch: Array,
    toe_out_rad: float,
) -> None:
    """Turn thigh, shin and foot so that the ankle meets its target (two-bone inverse kinematics).

    Args:
        side: "left" or "right".
        offsets: (17, 3) [m] as returned by `joint_offsets`.
        rotations: (N, 17, 3) [rad] rotation vectors of the bones; those of the leg are replaced.
        pelvis: (N, 3) [m] in the person's frame.
        ankle: likewise.
        pitch: (N,) [rad] of the foot, toe down positive.
        toe_out_rad: outward angle of the foot.
    """
    from scipy.spatial.transform import Rotation  # here, as it is slow to import

    thigh, shin = leg_lengths(offsets)
    hip_turn = Rotation.from_rotvec(rotations[:, 0])
    gap = ankle - pelvis - hip_turn.apply(offsets[BONE_INDEX[f"{side}_thigh"]])
    distance = np.minimum(np.linalg.norm(gap, axis=1), thigh + shin - 1e-6)
    knee = np.arccos(np.clip((distance**2 - thigh**2 - shin**2) / (2.0 * thigh * shin), -1.0, 1.0))
    before_knee = np.arctan2(shin * np.sin(knee), thigh + shin * np.cos(knee))
    yaw = lateral(side) * toe_out_rad
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
