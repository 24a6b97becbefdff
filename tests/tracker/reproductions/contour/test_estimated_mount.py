"""What people tell of a camera that nobody calibrated."""

from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.reproductions.contour.estimated_mount import MountBelief, believed_from, is_learnable
from peopleboy.tracker.reproductions.contour.particle_filter import is_within
from peopleboy.tracker.reproductions.contour.particles import CROWN, FOOT, H, W, X, Y, limits_px
from peopleboy.tracker.reproductions.contour.variants import VARIANTS

CONTOUR = VARIANTS["contour"]
LIMITS = CONTOUR.detector.limits


def standing(geometry: Pinhole, distance_m: float, stature_m: float = 1.72) -> np.ndarray:
    """State (9,) of somebody on the floor, as a camera sees it."""
    ends = np.array([[distance_m, 0.0, stature_m], [distance_m, 0.0, 0.0]])
    head, foot = geometry.calibration.project(ends)[:, 1]
    state = np.zeros(9)
    h = (foot - head) / (CROWN + FOOT)
    state[[X, Y, W, H]] = 160.0, foot - FOOT * h, 0.4 * h, h
    return state


def camera(height_m: float, pitch_deg: float) -> Pinhole:
    return Pinhole(position_m=(0.0, 0.0, height_m), pitch_rad=math.radians(pitch_deg))


def taught(geometry: Pinhole) -> MountBelief:
    belief = MountBelief.usual(LIMITS)
    for distance_m in np.tile(np.linspace(3.5, 9.0, 60), 3):
        belief = belief.learnt(standing(geometry, distance_m), 240)
    return belief


@pytest.mark.parametrize(("height_m", "pitch_deg"), [(1.2, 0.0), (0.5, 6.0), (1.7, -6.0), (1.2, 10.0)])
def test_somebody_who_walks_to_and_fro_tells_horizon_and_height(height_m: float, pitch_deg: float) -> None:
    geometry = camera(height_m, pitch_deg)
    far = geometry.calibration.project(np.array([[1e7, 0.0, height_m]]))[0, 1]
    horizon, below = taught(geometry).line.tolist()
    assert horizon == pytest.approx(far / 240, abs=0.02)
    assert below == pytest.approx(height_m / 1.72 * (CROWN + FOOT) - FOOT, abs=0.2)


@pytest.mark.parametrize(
    ("height_m", "pitch_deg"), [(1.2, -15.0), (1.2, 0.0), (1.2, 15.0), (0.4, 0.0), (1.8, 0.0)]
)
def test_nobody_is_ruled_out_before_anybody_was_seen(height_m: float, pitch_deg: float) -> None:
    limits = believed_from(CONTOUR, MountBelief.usual(LIMITS)).detector.limits
    states = np.array([standing(camera(height_m, pitch_deg), away) for away in (4.0, 6.0, 8.0)], np.float32)
    assert is_within(states, limits_px(240, limits)).all()


def test_who_is_known_to_stand_higher_is_ruled_out() -> None:
    limits = believed_from(CONTOUR, taught(camera(1.2, 0.0))).detector.limits
    state = standing(camera(1.2, 0.0), 5.0).astype(np.float32)
    raised = state.copy()
    raised[Y] -= 1.5 * state[H]
    assert list(is_within(np.array([state, raised]), limits_px(240, limits))) == [True, False]


def test_the_surer_the_mount_the_fewer_samples_look() -> None:
    unsure, sure = (
        believed_from(CONTOUR, belief).detector.count
        for belief in (MountBelief.usual(LIMITS), taught(camera(1.2, 0.0)))
    )
    assert CONTOUR.detector.count <= sure < 2 * CONTOUR.detector.count < unsure


def test_only_the_default_looks_for_people_on_the_floor() -> None:
    learnable = {name for name, config in VARIANTS.items() if is_learnable(config)}
    assert learnable == {"contour", "learned"}
