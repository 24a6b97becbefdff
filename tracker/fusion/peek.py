"""Looking for somebody who is known where it is expected in the depth image, as far as it can be seen there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import DEPTH, Floats, Frame
from peopleboy.tracker.fusion.glance import depth_of, warm_share_of
from peopleboy.tracker.rgbd.detection.depth_view import DepthView
from peopleboy.tracker.rgbd.people.look_at import Body, box_at
from peopleboy.tracker.rgbd.people.looks import BINS

_LOW_M: Final = 0.8  # above the floor, from which on arms and legs do not spread
_HIGH: Final = 0.92  # share of the height, up to which there are shoulders
_ROWS: Final = 12
_COLUMNS: Final = 25
_ASIDE: Final = 0.75  # widths to either side of the middle that are looked at, beyond the body
_REACH_M: Final = 0.35
_BODY_M: Final = 0.1  # from the surface that is seen to the middle of the body
_MOST: Final = 0.5  # share of a column's readings that decide about it
_LEAST_SHARE: Final = 0.15
_WIDEST: Final = 1.5
_EDGE_SD_M: Final = 0.06
_RANGE_SD_M: Final = 0.06


@dataclass(frozen=True, slots=True, eq=False)
class Peek:
    """What of a person the depth image shows.

    Attributes:
        place_m: (2,) forward, left in the robot's frame [m].
        share: of its width that is seen.
        warm: share of what is seen that is as warm as people are; None where the thermal image shows nothing.
    """

    place_m: Floats
    share: float
    warm: float | None


def peek(place_m: Floats, wide_m: float, tall_m: float, frame: Frame) -> Peek | None:
    """Find the middle of a person's shoulders from the sides of them that nobody covers.

    A side beside which something nearer stands is no side of the person: its middle is half a width from
    the other one.

    Returns:
        None where nothing of the person is seen, or more than one person may be.
    """
    if DEPTH not in frame.images or DEPTH not in frame.calibrations:
        return None
    view = DepthView.of(frame.calibrations[DEPTH], DEPTH)
    left, top, width, height = box_at(view, place_m, Body(wide_m, _HIGH * tall_m, _LOW_M, np.zeros(BINS)))
    depth = frame.depth(DEPTH)
    u = np.rint(left + width / 2.0 + width * (0.5 + _ASIDE) * np.linspace(-1.0, 1.0, _COLUMNS)).astype(np.int64)
    v = np.rint(top + height * (np.arange(_ROWS) + 0.5) / _ROWS).astype(np.int64)
    u, v = u[(u >= 0) & (u < depth.shape[1])], v[(v >= 0) & (v < depth.shape[0])]
    if width <= 0.0 or len(u) < 3 or len(v) < 3:
        return None
    z = depth[np.ix_(v, u)] / 1000.0
    at = depth_of(place_m, frame) - _BODY_M
    is_read, is_own, is_near = z > 0.0, np.abs(z - at) < _REACH_M, (z > 0.0) & (z <= at - _REACH_M)
    readings = np.maximum(is_read.sum(axis=0), 1)
    own, near = is_own.sum(axis=0) / readings > _MOST, is_near.sum(axis=0) / readings > _MOST
    run = _longest(own)
    if run is None:
        return None
    first, last = run
    step = (u[-1] - u[0]) / (len(u) - 1)
    wide = (u[last] - u[first] + step) / width
    if wide < _LEAST_SHARE or wide > _WIDEST:
        return None
    starts, ends = u[first] - step / 2.0, u[last] + step / 2.0
    left_free, right_free = first > 0 and not near[first - 1], last < len(u) - 1 and not near[last + 1]
    if left_free and right_free:
        if wide < 0.6:
            return None
        middle = (starts + ends) / 2.0
    elif left_free:
        middle = starts + max(width, ends - starts) / 2.0
    elif right_free:
        middle = ends - max(width, ends - starts) / 2.0
    else:
        return None
    block = is_own[:, first : last + 1]
    range_m = float(np.median(z[:, first : last + 1][block]))
    if range_m * 0 != 0 or abs(middle - left - width / 2.0) > 0.8 * width:
        return None
    z_m = range_m + _BODY_M
    x_m = (middle - view.centre_u) / view.focal_px * z_m
    rows, columns = np.nonzero(block)
    pixels = np.stack([u[first + columns], v[rows]], axis=1)
    warm = warm_share_of(pixels, z[rows, first + columns], frame)
    place = view.on_floor(np.array([x_m]), np.array([z_m]))[0]
    return Peek(np.asarray(place), min(1.0, float(wide)), warm)


def _longest(flags: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Give first and last index of the longest run; gaps of one do not count."""
    closed = flags.copy()
    closed[1:-1] |= flags[:-2] & flags[2:]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], closed, [False]]).astype(np.int8)))
    if len(edges) == 0:
        return None
    starts, ends = edges[::2], edges[1::2]
    best = int(np.argmax(ends - starts))
    return int(starts[best]), int(ends[best]) - 1
