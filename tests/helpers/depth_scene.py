"""Depth images of floors, walls and upright boxes, by closed form."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.sensors.depth.depth_view import Depth, DepthView
from tests.helpers.images.as_taken import as_taken

FOCAL_PX = 300.0
WIDTH, HEIGHT = 320, 240


@dataclass(frozen=True, slots=True)
class Block:
    """An upright front, as a depth camera sees a body: x to the right, z away, from the floor up [m]."""

    x_m: float
    z_m: float
    width_m: float = 0.45
    height_m: float = 1.65


def make_view(height_m: float = 1.2, pitch_rad: float = 0.0) -> DepthView:
    """A camera above the robot's origin, by default level; a positive pitch points down."""
    cos, sin = math.cos(pitch_rad), math.sin(pitch_rad)
    pose = np.array(
        [[0.0, -sin, cos, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -cos, -sin, height_m], [0.0, 0.0, 0.0, 1.0]]
    )
    intrinsics = np.array(
        [[FOCAL_PX, 0.0, (WIDTH - 1) / 2], [0.0, FOCAL_PX, (HEIGHT - 1) / 2], [0.0, 0.0, 1.0]]
    )
    return DepthView.of(PinholeCalibration(intrinsics, pose), "depth")


def depth_of(
    blocks: Sequence[Block] = (),
    *,
    height_m: float = 1.2,
    ceiling_m: float = 2.7,
    wall_m: float = 9.0,
    horizon_px: float = 0.0,
    pitch_rad: float = 0.0,
) -> Depth:
    """Draw floor, ceiling, a wall across and blocks (H, W) [mm]."""
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    across = (u - (WIDTH - 1) / 2) / FOCAL_PX
    down = (v - (HEIGHT - 1) / 2 - horizon_px) / FOCAL_PX
    cos, sin = math.cos(pitch_rad), math.sin(pitch_rad)
    ahead = cos - sin * down  # level distance by depth
    across, down = across / ahead, (cos * down + sin) / ahead
    with np.errstate(divide="ignore"):
        floor = np.where(down > 0, height_m / down, np.inf)
        ceiling = np.where(down < 0, (height_m - ceiling_m) / down, np.inf)
    depth = np.minimum(np.minimum(floor, ceiling), wall_m)
    for block in blocks:
        top, bottom = height_m - block.height_m, height_m
        is_in = np.abs(across * block.z_m - block.x_m) <= block.width_m / 2
        is_in &= (down * block.z_m >= top) & (down * block.z_m <= bottom) & (block.z_m < depth)
        depth = np.where(is_in, block.z_m, depth)
    return as_taken(np.round(1000.0 * depth / ahead).astype(np.uint16))
