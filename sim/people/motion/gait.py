"""Gait: the poses of a body, tabulated by stride length and phase, and their look-up."""

import math
from collections.abc import Callable
from functools import cached_property, partial
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.people.body.body_shapes import SIDES
from peopleboy.sim.people.body.skeleton import BONES
from peopleboy.sim.people.motion.manner import USUAL, Manner
from peopleboy.sim.people.motion.motion_clips import load_motion_clip
from peopleboy.sim.people.motion.steps import PHASES, RUNNING_AMPLITUDE, Steps, bend_leg

Array = NDArray[np.float64]

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
) -> tuple[float, float, float]:
    """Look a pose up in tables (A, P, 17, 3) and (A, P, 3) of `Gait`, at a phase [cycles].

    Returns:
        Offset of the pelvis [m] to the front and to the left, and the height [m] of the lowest sole above the
        floor; fills `turns` (17, 3) with rotation vectors.
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
    front = left = up = 0.0
    for corner in range(4):
        a, p = i + corner // 2, following if corner % 2 else j
        weight = (di if corner // 2 else 1.0 - di) * (dj if corner % 2 else 1.0 - dj)
        front += weight * sway[a, p, 0]
        left += weight * sway[a, p, 1]
        up += weight * sway[a, p, 2]
        for bone in range(turns.shape[0]):
            for axis in range(3):
                turns[bone, axis] += weight * rotations[a, p, bone, axis]
    return front, left, up


class Gait:
    """Poses of one body for every phase and stride length.

    Args:
        root_scale: root of the leg length relative to the clips'.
        unit_stride_m: travel [m] per cycle of amplitude 1.
        make_tables: computes (A, P, 17, 3) [rad] rotation vectors of the bones for amplitudes and phases, and
            (A, P, 3) [m] offset of the pelvis from the person's steadily moving position to the front and to
            the left, and of the lowest sole from the floor.
    """

    def __init__(
        self, root_scale: float, unit_stride_m: float, make_tables: Callable[[], tuple[Array, Array]]
    ) -> None:
        self.root_scale, self.unit_stride_m = root_scale, unit_stride_m
        self._make_tables = make_tables

    def rebind(self, rotations: Array, sway: Array) -> None:
        """Use other arrays for the tables from now on; they must hold the same values already."""
        self.tables = rotations, sway

    @cached_property
    def tables(self) -> tuple[Array, Array]:
        """The tables, computed when a camera first needs them."""
        return self._make_tables()


def walking_gait(offsets: Array, soles: Array, stature_m: float, manner: Manner = USUAL) -> Gait:
    """Return the gait of a person who walks, or runs.

    People who run have poses of running from `RUNNING_AMPLITUDE` on; towards the next shorter stride in the
    tables, poses are interpolated between both.

    Args:
        offsets: (17, 3) [m] as returned by `joint_offsets`.
        soles: (3, 3) [m] as returned by `sole_points`.
        stature_m: [m].
        manner: how the person walks.
    """
    walk, run = (
        Steps(offsets, soles, stature_m, manner, load_motion_clip(name)) for name in ("walking", "running")
    )
    unit_stride_m = load_motion_clip("walking").stride_m * walk.scale * manner.stride
    tables = partial(_walking_tables, walk, run if manner.runs else None, offsets, unit_stride_m, manner)
    return Gait(math.sqrt(walk.scale), unit_stride_m, tables)


def _walking_tables(
    walk: Steps, run: Steps | None, offsets: Array, unit_stride_m: float, manner: Manner
) -> tuple[Array, Array]:
    cycles = [
        walk.walk(amplitude, unit_stride_m * amplitude)
        if run is None or amplitude < RUNNING_AMPLITUDE
        else run.run(amplitude, unit_stride_m * amplitude)
        for amplitude in AMPLITUDES.tolist()
    ]
    rotations = np.concatenate([each.rotations for each in cycles])
    pelvis = np.concatenate([each.pelvis_m for each in cycles])
    for side in SIDES:
        ankle = np.concatenate([each.ankle_m[side] for each in cycles])
        pitch = np.concatenate([each.pitch_rad[side] for each in cycles])
        bend_leg(side, offsets, rotations, pelvis, ankle, pitch, manner.toe_out_rad)
    pelvis[:, 2] = np.concatenate([each.lift_m for each in cycles])
    shape = len(AMPLITUDES), PHASES
    return rotations.reshape(*shape, len(BONES), 3), pelvis.reshape(*shape, 3)
