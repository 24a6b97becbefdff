"""The time-varying stance of people (gait phase, postures, gaze) as arrays for kernels."""

import math
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import (
    WAVE_HZ,
    WAVE_RAD,
    Posture,
    change_times_s,
    pelvis_shift,
    posture_rotations,
)
from peopleboy.sim.people.body.skeleton import ARM_BONES, BONE_INDEX, BONES
from peopleboy.sim.people.motion.gait import amplitude_of, gait_pose

# Range and rate of head turning, and the share of each bone in it: our choice.
_FARTHEST_RAD: Final = math.radians(100.0)
_RATE_RAD_S: Final = math.radians(200.0)
GAZE_SHARES: Final[Mapping[str, float]] = {"chest": 0.2, "neck": 0.3, "head": 0.5}
_BEHIND_RAD: Final = math.radians(150.0)  # beyond this bearing a person keeps looking over the same shoulder


class Gaze:
    """The head's direction to the left [rad], which follows a target."""

    def __init__(self) -> None:
        self.left_rad = 0.0

    def update(self, dt_s: float, bearing_rad: float | None) -> None:
        """Turn towards a bearing from the body's front, positive left, or back to the front for None."""
        off = 0.0 if bearing_rad is None else math.remainder(bearing_rad, math.tau)
        if abs(off) > _BEHIND_RAD and self.left_rad:
            off = math.copysign(off, self.left_rad)
        wanted = min(max(off, -_FARTHEST_RAD), _FARTHEST_RAD)
        step = _RATE_RAD_S * dt_s
        self.left_rad += min(max(wanted - self.left_rad, -step), step)


Array = NDArray[np.float64]
Stances = NDArray[Any]

POSTURES: Final = {posture: number for number, posture in enumerate(Posture)}
STANCE: Final = np.dtype(
    [
        ("phase", np.float64),  # [cycles]
        ("speed", np.float64),  # [m/s] of the legs
        ("blend", np.float64, len(POSTURES)),  # progress into each posture, before easing
        ("time_s", np.float64),
        ("sway_phase", np.float64),  # [cycles]
        ("gaze_rad", np.float64),  # to the left
    ]
)
"""The time-varying state of one person, its position and heading aside."""

_STANDING, _CALLING = POSTURES[Posture.STANDING], POSTURES[Posture.CALLING]
_ROTATIONS = np.array([posture_rotations(posture) for posture in Posture])
_SHIFTS = np.array([pelvis_shift(posture) for posture in Posture])
_CHANGE_S = np.array([change_times_s(posture) for posture in Posture])  # to take up and to leave each
_ARMS = np.array(ARM_BONES, np.int64)
_BAG_ARM = np.array([BONE_INDEX[f"right_{bone}"] for bone in ("upper_arm", "forearm", "hand")], np.int64)
_FEET = np.array([BONE_INDEX["left_foot"], BONE_INDEX["right_foot"]], np.int64)
_LOOKING = np.array([BONE_INDEX[bone] for bone in GAZE_SHARES], np.int64)
_LOOKING_SHARES = np.array(list(GAZE_SHARES.values()))
_PELVIS, _HEAD, _WAVING = BONE_INDEX["pelvis"], BONE_INDEX["head"], BONE_INDEX["left_forearm"]
_BONES = len(BONES)

_BAG_SWING = 0.25
_HELD_SWING = 0.2  # swing of an arm that holds something, relative to a free arm
_SWAY_RAD, _SWAY_HZ = 0.006, 0.23
_LOOK_RATIO = 0.57  # frequency of looking about relative to that of swaying
_CYCLES_PER_RAD = 0.4  # [gait cycles/rad] steps while turning on the spot
_SPEED_CHANGE_M_S2 = 3.0


class Builds(NamedTuple):
    """The constant properties of Q people.

    Attributes:
        rotations, sway: (Q, A, P, 17, 3) [rad] and (Q, A, P, 3) [m] gait tables of `Gait`.
        root_scale: (Q,) scale of the gaits, see `Gait`.
        height_m: (Q,).
        held, is_held: (Q, 17, 3) [rad] and (Q, 17) arms that hold something.
        arms: (Q,) index of the posture that the arms always keep, -1 for none.
        has_bag: (Q,).
        looks_about_rad: (Q,).
    """

    rotations: Array
    sway: Array
    root_scale: Array
    height_m: Array
    held: Array
    is_held: NDArray[np.bool_]
    arms: NDArray[np.int64]
    has_bag: NDArray[np.bool_]
    head_sweep_rad: Array


@njit(cache=True, nogil=True)
def move_limbs(
    stances: Stances,
    q: int,
    unit_stride_m: float,
    root_scale: float,
    pace_m_s: float,
    turn_rad_s: float,
    is_walking: bool,
    posture: int,
    dt_s: float,
) -> None:
    """Advance gait and postures of one of Q people by a time step.

    Args:
        stances: (Q,) records STANCE; the person's record is changed in place.
        q: number of the person.
        unit_stride_m: see `Gait`.
        root_scale: likewise.
        pace_m_s: speed of the feet over the floor.
        turn_rad_s: turn rate of the person.
        is_walking: whether the person is walking.
        posture: index of the posture to take up in `POSTURES`.
        dt_s: [s].
    """
    stance, change = stances[q], _SPEED_CHANGE_M_S2 * dt_s
    stance.speed += min(max(pace_m_s - stance.speed, -change), change)
    amplitude = amplitude_of(stance.speed, root_scale)
    walking_hz = stance.speed / (unit_stride_m * amplitude) if amplitude > 1e-3 else 0.0
    turning_hz = 0.0 if is_walking else _CYCLES_PER_RAD * abs(turn_rad_s)
    stance.phase = (stance.phase + max(walking_hz, turning_hz) * dt_s) % 1.0
    for k in range(len(stance.blend)):
        wanted = 1.0 if k == posture else 0.0
        more, less = dt_s / _CHANGE_S[k, 0], dt_s / _CHANGE_S[k, 1]
        stance.blend[k] += min(max(wanted - stance.blend[k], -less), more)


@njit(cache=True, nogil=True)
def hold(builds: Builds, stances: Stances, q: int, turns: Array) -> tuple[float, float, float]:
    """Return the pose of one of Q people from gait, postures, arms, gaze and sway.

    Returns:
        Offset of the pelvis [m] to the front and to the left, and the height [m] of the lowest sole above the
        floor; the rotation vectors [rad] go to `turns`.
    """
    stance = stances[q]
    amplitude = amplitude_of(stance.speed, builds.root_scale[q])
    front, left, up = gait_pose(builds.rotations[q], builds.sway[q], stance.phase, amplitude, turns)
    weights, arms = np.empty(len(stance.blend)), 0.0
    for k in range(len(weights)):
        weights[k] = stance.blend[k] * stance.blend[k] * (3.0 - 2.0 * stance.blend[k])
        arms += weights[k] if k != _STANDING else 0.0
    own = builds.arms[q]
    if own >= 0:
        weights[own] = max(weights[own], 1.0 - arms)
        arms = 1.0
    _keep_arms(builds, q, min(arms, 1.0), turns)
    for k in range(len(weights)):
        if weights[k] > 0.0 and k != _STANDING:
            turns += weights[k] * (_ROTATIONS[k] - _ROTATIONS[_STANDING])
            front += weights[k] * _SHIFTS[k] * builds.height_m[q]
    _sway(stance.time_s, stance.sway_phase, builds.head_sweep_rad[q], turns)
    if weights[_CALLING] > 0.0:
        swung = WAVE_RAD * math.sin(2.0 * math.pi * WAVE_HZ * stance.time_s)
        turns[_WAVING, 0] += weights[_CALLING] * swung
    if stance.gaze_rad != 0.0:
        for k in range(len(_LOOKING)):
            turns[_LOOKING[k], 2] += _LOOKING_SHARES[k] * stance.gaze_rad
    return front, left, up


@njit(cache=True)
def _keep_arms(builds: Builds, q: int, share: float, turns: Array) -> None:
    """Apply held arms, arms that hang as a posture requires, and the smaller swing of a hand with a bag."""
    standing = _ROTATIONS[_STANDING]
    for bone in range(_BONES):
        if builds.is_held[q, bone]:
            for k in range(3):
                turns[bone, k] = builds.held[q, bone, k] + _HELD_SWING * (turns[bone, k] - standing[bone, k])
    for bone in _ARMS:
        for k in range(3):
            turns[bone, k] += share * (standing[bone, k] - turns[bone, k])
    if builds.has_bag[q]:
        for bone in _BAG_ARM:
            for k in range(3):
                turns[bone, k] = standing[bone, k] + _BAG_SWING * (turns[bone, k] - standing[bone, k])


@njit(cache=True)
def _sway(time_s: float, sway_phase: float, head_sweep_rad: float, turns: Array) -> None:
    """Sway about the ankles."""
    angle = 2.0 * math.pi * (_SWAY_HZ * time_s + sway_phase)
    lean = _SWAY_RAD * math.sin(angle), _SWAY_RAD * math.cos(0.71 * angle)
    for k in range(2):
        turns[_PELVIS, k] += lean[k]
    turns[_HEAD, 2] += head_sweep_rad * math.sin(_LOOK_RATIO * angle)
    for foot in _FEET:
        for k in range(2):
            turns[foot, k] -= lean[k]
