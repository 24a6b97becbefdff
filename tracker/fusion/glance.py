"""What the depth image shows where somebody may stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from peopleboy.tracker.frame import DEPTH, Floats, Frame
from peopleboy.tracker.fusion.warmth import depths_at, grid, warm_share
from peopleboy.tracker.rgbd.detection.depth_view import DepthView
from peopleboy.tracker.rgbd.people.look_at import Body, box_at
from peopleboy.tracker.rgbd.people.looks import BINS

BODY_M: Final = 0.1  # from the surface that is seen to the middle of a body
REACH_M: Final = 0.4  # from that surface, within which readings belong to it

_COLUMNS: Final = 8
_ROWS: Final = 16
_LEAST: Final = 12  # readings from which on shares mean anything
_NO_LOOKS: Final = np.zeros(BINS)


@dataclass(frozen=True, slots=True)
class Glimpse:
    """What stands where somebody may be.

    Attributes:
        nearer, beyond: shares of the readings before and behind the person.
        warm: share of its own that is as warm as people are; None where the thermal image shows too few.
    """

    nearer: float
    beyond: float
    warm: float | None


def glance(
    place_m: Floats, wide_m: float, tall_m: float, frame: Frame, reach_m: float = REACH_M
) -> Glimpse | None:
    """Look at the middle of somebody at a place (2,) in the robot's frame.

    Args:
        place_m: forward, left [m].
        wide_m: width of the person.
        tall_m: height likewise.
        frame: with a depth image, if there is one.
        reach_m: [m] by which the person may be nearer or farther.

    Returns:
        None where the depth image does not show that place, or there is none.
    """
    view = view_of(frame)
    if view is None:
        return None
    left, top, width, height = box_at(view, place_m, _body(wide_m, tall_m, 0.0))
    if width <= 0.0:
        return None
    middle = (left + 0.2 * width, top + 0.05 * height, 0.6 * width, 0.8 * height)
    pixels = grid(middle, _COLUMNS, _ROWS, frame)
    z_m = depths_at(pixels, frame)
    pixels, z_m = pixels[z_m > 0.0], z_m[z_m > 0.0]
    if len(z_m) < _LEAST:
        return None
    off = z_m - surface_m(view, place_m)
    own = np.abs(off) < reach_m
    return Glimpse(
        nearer=float((off <= -reach_m).mean()),
        beyond=float((off >= reach_m).mean()),
        warm=warm_share(pixels[own], z_m[own], frame),
    )


def view_of(frame: Frame) -> DepthView | None:
    """Give the geometry of a frame's depth image; None without one."""
    if DEPTH not in frame.images or DEPTH not in frame.calibrations:
        return None
    return DepthView.of(frame.calibrations[DEPTH], DEPTH)


def shoulders(view: DepthView, place_m: Floats, wide_m: float, low_m: float, high_m: float) -> Floats:
    """Give left, top, width, height [px] of a body from one height above the floor to another."""
    return np.array(box_at(view, place_m, _body(wide_m, high_m, low_m)))


def surface_m(view: DepthView, place_m: Floats) -> float:
    """Give the depth [m] at which the camera sees the surface of somebody at a place (2,)."""
    pose = view.calibration.robot_from_camera
    point = np.array([*place_m, pose[2, 3]])
    return float((point - pose[:3, 3]) @ pose[:3, 2]) - BODY_M


def _body(wide_m: float, high_m: float, low_m: float) -> Body:
    return Body(width_m=wide_m, head_m=high_m, low_m=low_m, looks=_NO_LOOKS)
