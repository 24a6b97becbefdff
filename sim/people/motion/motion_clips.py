"""Motion-captured cycles of walking and running, as Fourier series in the phase."""

import functools
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HARMONICS = 5
# Thigh and shin of the clips' figure [m]: DeepMimic's humanoid.
CLIP_LEG_M: Final = 0.421546 + 0.409870


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MotionClip:
    """One cycle of a gait; phase 0 is about the right heel's strike.

    Attributes:
        rotations: (2K+1, 17, 3) [rad] coefficients of 1, cos, sin, cos 2, ... of the bones' rotation vectors.
        sway: (2K+1, 3) [m] the same for the pelvis' deviation from steady motion; x front, y left, z up.
        stride_m: [m] travel per cycle.
        heel_strike, toe_off: [cycles] between which the left foot is on the floor.
        flat_rad: pitch up to which a foot counts as flat.
        lead: [cycles] lead of the body over the middle of its feet, chosen for the longest reach of the legs.
        bob: share of the vertical movement that is kept.
        lean: share of the figure's forward lean that is kept.
        reach: [leg lengths] longest reach of a leg; a knee is never fully straight.
    """

    rotations: Array
    sway: Array
    stride_m: float
    heel_strike: float
    toe_off: float
    flat_rad: float
    lead: float
    bob: float
    lean: float
    reach: float


ClipName = Literal["walking", "running"]
# Contacts were read from the clips. People rise and fall less in each step than they would on stiff legs, and
# lean less than the clips' figure; at our speeds they also rise less than the runner of the clip, at 3.6 m/s.
_READINGS: Final[Mapping[ClipName, Mapping[str, Any]]] = {
    "walking": {
        "heel_strike": 0.485,
        "toe_off": 1.085,
        "flat_rad": math.radians(3.0),
        "lead": 0.055,
        "bob": 0.7,
        "lean": 0.5,
        "reach": 0.998,
    },
    "running": {
        "heel_strike": 0.44,
        "toe_off": 0.76,
        "flat_rad": math.radians(8.0),
        "lead": 0.0,
        "bob": 0.5,
        "lean": 0.5,
        "reach": 0.97,
    },
}


def fourier_basis(phase: Array) -> Array:
    """Return (..., 2K+1) the functions 1, cos, sin, cos 2, sin 2, ... at phases given in cycles."""
    angles = 2.0 * math.pi * np.asarray(phase)[..., None] * np.arange(1, _HARMONICS + 1)
    waves = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return np.concatenate([np.ones((*waves.shape[:-2], 1)), waves.reshape(*waves.shape[:-2], -1)], axis=-1)


@functools.cache
def load_motion_clip(name: ClipName) -> MotionClip:
    """Read a clip as five harmonics; tests fit them again.

    Source: humanoid3d_walk.txt and humanoid3d_run.txt of pybullet_data, which are DeepMimic's (Peng et al.,
    2018; MIT licence).
    """
    data = json.loads(Path(__file__).with_name(f"{name}.json").read_text("utf-8"))
    rotations, sway = np.array(data["rotations"]), np.array(data["sway"])
    for array in (rotations, sway):
        array.setflags(write=False)
    return MotionClip(rotations=rotations, sway=sway, stride_m=data["stride_m"], **_READINGS[name])
