import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES
from peopleboy.sim.people.motion.motion_clips import ClipName, fourier_basis, load_motion_clip
from peopleboy.sim.physics.urdf import data_folder

CLIPS = Path("data", "motions")

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


@pytest.mark.parametrize(
    ("name", "file"), [("walking", "humanoid3d_walk.txt"), ("running", "humanoid3d_run.txt")]
)
def test_a_gait_is_the_fit_of_five_harmonics_to_its_clip_without_the_jump_where_it_was_mirrored(
    name: ClipName, file: str
) -> None:
    clip = load_motion_clip(name)
    frames = np.array(json.loads((data_folder() / CLIPS / file).read_text("utf-8"))["Frames"])[:-1]
    count = len(frames)
    stride = (frames[-1, 1] - frames[0, 1]) * count / (count - 1)
    steady = stride * np.arange(count) / count
    sway = np.stack([frames[:, 1] - steady, -frames[:, 3], frames[:, 2]], axis=-1)
    series = np.concatenate([_rotation_vectors(frames).reshape(count, -1), sway], axis=1)
    fit = np.linalg.lstsq(fourier_basis(np.arange(count) / count), series, rcond=None)[0]
    assert clip.stride_m == stride
    np.testing.assert_allclose(clip.rotations, fit[:, :-3].reshape(-1, len(BONES), 3), atol=1e-12)
    np.testing.assert_allclose(clip.sway[1:], fit[1:, -3:], atol=1e-12)
    assert not clip.sway[0].any()


def _rotation_vectors(frames: np.ndarray) -> np.ndarray:
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


def _from_clip_quaternion(wxyz: np.ndarray) -> np.ndarray:
    w, x, y, z = wxyz.T
    vectors: np.ndarray = Rotation.from_quat(np.stack([x, -z, y, w], axis=-1)).as_rotvec()
    return vectors
