"""Depth images of a room in which boxes stand, computed in closed form."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, THERMAL, Frame, Odometry

HEIGHT, WIDTH, FOCAL_PX, CAMERA_M = 120, 160, 140.0, 1.2
WALL_M = 5.0
COLD, WARM = 0, 200


@dataclass(frozen=True, slots=True)
class Screen:
    """An upright rectangle that faces the camera: ahead, left edge, right edge, foot and top [m]."""

    ahead_m: float
    left_m: float
    right_m: float
    foot_m: float
    top_m: float
    is_warm: bool = False
    rgb: tuple[int, int, int] = (200, 40, 40)


def calibration() -> PinholeCalibration:
    """A level camera, looking ahead."""
    intrinsics = np.array([[FOCAL_PX, 0.0, WIDTH / 2], [0.0, FOCAL_PX, HEIGHT / 2], [0.0, 0.0, 1.0]])
    pose = np.array([[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, CAMERA_M], [0, 0, 0, 1.0]])
    return PinholeCalibration(intrinsics, pose)


def true_depth(screens: Sequence[Screen]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(H, W) depth [m] of wall, floor and screens, and the number of the screen seen, from 1; 0 for none."""
    v, u = np.mgrid[:HEIGHT, :WIDTH].astype(np.float64)
    aside, down = (WIDTH / 2 - u) / FOCAL_PX, (v - HEIGHT / 2) / FOCAL_PX
    with np.errstate(divide="ignore"):
        depth = np.minimum(WALL_M, np.where(down > 0.0, CAMERA_M / down, math.inf))
    owner = np.zeros((HEIGHT, WIDTH), np.int64)
    for number, one in enumerate(screens, 1):
        left, up = aside * one.ahead_m, CAMERA_M - down * one.ahead_m
        is_in = (one.right_m < left) & (left < one.left_m) & (one.foot_m < up) & (up < one.top_m)
        is_in &= one.ahead_m < depth
        depth[is_in], owner[is_in] = one.ahead_m, number
    return depth, owner


def room_frame(
    k: int,
    screens: Sequence[Screen],
    *,
    rng: np.random.Generator | None = None,
    has_heat: bool = True,
    odometry: Odometry | None = Odometry(),  # noqa: B008
) -> Frame:
    """Give the k-th frame at 15 Hz, with noise that grows with the square of depth if a generator is told."""
    depth, owner = true_depth(screens)
    if rng is not None:
        depth = depth + 0.0015 * depth**2 * rng.standard_normal(depth.shape)
    colours = np.array([(120, 120, 120), *(one.rgb for one in screens)], np.uint8)
    heat = np.array([COLD, *(WARM if one.is_warm else COLD for one in screens)], np.uint8)
    images = {DEPTH: np.rint(1000.0 * depth).astype(np.uint16), DEPTH_COLOUR: colours[owner]}
    calibrations = {DEPTH: calibration()}
    if has_heat:
        images[THERMAL] = heat[owner]
        calibrations[THERMAL] = calibrations[DEPTH]
    return Frame(images=images, time_s=k / 15.0, calibrations=calibrations, odometry=odometry)
