"""The walking clip of pybullet_data, in our frames and as smooth functions of the gait's phase."""

from __future__ import annotations

import functools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES
from peopleboy.sim.physics.model_files import data_folder

Array = NDArray[np.float64]

_CLIP = Path("data", "motions", "humanoid3d_walk.txt")
_HARMONICS = 5
# Thigh and shin of the clip's figure [m]: DeepMimic's humanoid.
CLIP_LEG_M = 0.421546 + 0.409870

# Where each joint's numbers start in a frame: frame time, root position, root rotation, chest, neck, ...
_BALL_JOINTS = {
    "pelvis": 4,
    "right_foot": 21,
    "right_upper_arm": 25,
    "left_foot": 35,
    "left_upper_arm": 39,
    "right_thigh": 16,
    "left_thigh": 30,
}
_HINGES = {"right_shin": 20, "right_forearm": 29, "left_shin": 34, "left_forearm": 43}
# The clip has one joint where we have two: each takes half.
_SHARED_JOINTS = {("abdomen", "chest"): 8, ("neck", "head"): 12}


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
    """Read the clip and close its loop.

    The last frame repeats the first, one cycle later. Five harmonics fit the rest, which takes away the jump
    where the clip was mirrored.

    Raises:
        FileNotFoundError: pybullet_data is not installed.
    """
    frames = _read_frames()[:-1]
    count = len(frames)
    basis = fourier_basis(np.arange(count) / count)
    stride = (frames[-1, 1] - frames[0, 1]) * count / (count - 1)
    steady = stride * np.arange(count) / count
    sway = np.stack([frames[:, 1] - steady, -frames[:, 3], frames[:, 2]], axis=-1)
    rotations = _rotation_vectors(frames)
    fit = np.linalg.lstsq(basis, np.concatenate([rotations.reshape(count, -1), sway], axis=1), rcond=None)[0]
    coefficients = fit[:, :-3].reshape(-1, len(BONES), 3)
    coefficients.setflags(write=False)
    return WalkingClip(rotations=coefficients, sway=_without_mean(fit[:, -3:]), stride_m=float(stride))


def _without_mean(coefficients: Array) -> Array:
    swinging = coefficients.copy()
    swinging[0] = 0.0
    swinging.setflags(write=False)
    return swinging


def _read_frames() -> Array:
    """(F, 44) frames of the clip, as DeepMimic's format orders them."""
    return np.array(json.loads((data_folder() / _CLIP).read_text("utf-8"))["Frames"])


def _rotation_vectors(frames: Array) -> Array:
    """(F, 17, 3) [rad] rotation vectors in our frames: the clip's x, y, z are our x, z, -y."""
    rotations = np.zeros((len(frames), len(BONES), 3))
    for bone, start in _BALL_JOINTS.items():
        rotations[:, BONE_INDEX[bone]] = _from_clip_quaternion(frames[:, start : start + 4])
    for bone, column in _HINGES.items():
        rotations[:, BONE_INDEX[bone], 1] = -frames[:, column]
    for bones, start in _SHARED_JOINTS.items():
        for bone in bones:
            rotations[:, BONE_INDEX[bone]] = _from_clip_quaternion(frames[:, start : start + 4]) / len(bones)
    return rotations


def _from_clip_quaternion(wxyz: Array) -> Array:
    w, x, y, z = wxyz.T
    vectors: Array = Rotation.from_quat(np.stack([x, -z, y, w], axis=-1)).as_rotvec()
    return vectors
