"""One cycle of walking, motion-captured, in our frames and as smooth functions of the gait's phase."""

from __future__ import annotations

import functools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CLIP = Path(__file__).with_name("walking_clip.json")
_HARMONICS = 5
# Thigh and shin of the clip's figure [m]: DeepMimic's humanoid.
CLIP_LEG_M = 0.421546 + 0.409870


@dataclass(frozen=True, slots=True, eq=False)
class WalkingClip:
    """One cycle of walking as Fourier series in the phase; phase 0 is about the right heel's strike.

    Attributes:
        rotations: (2K+1, 17, 3) [rad] coefficients of 1, cos, sin, cos 2, ... of the bones' rotation vectors.
        sway: (2K+1, 3) [m] the same of the pelvis' deviation from a steady walk; x front, y left, z up.
        stride_m: [m] travel in a cycle.
    """

    rotations: Array
    sway: Array
    stride_m: float


def fourier_basis(phase: Array) -> Array:
    """(..., 2K+1) the functions 1, cos, sin, cos 2, sin 2, ... at phases given in cycles."""
    angles = 2.0 * math.pi * np.asarray(phase)[..., None] * np.arange(1, _HARMONICS + 1)
    waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return np.concatenate([np.ones((*waves.shape[:-2], 1)), waves.reshape(*waves.shape[:-2], -1)], axis=-1)


@functools.cache
def load_walking_clip() -> WalkingClip:
    """Read what five harmonics make of the clip, which tests fit anew.

    Source: humanoid3d_walk.txt of pybullet_data, which is DeepMimic's (Peng et al., 2018; MIT licence).
    """
    data = json.loads(_CLIP.read_text("utf-8"))
    rotations, sway = np.array(data["rotations"]), np.array(data["sway"])
    for array in (rotations, sway):
        array.setflags(write=False)
    return WalkingClip(rotations=rotations, sway=sway, stride_m=data["stride_m"])
