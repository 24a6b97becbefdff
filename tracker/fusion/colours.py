"""What colours somebody has, by those readings of the depth image that are its own."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Floats, Frame
from peopleboy.tracker.fusion.glance import shoulders, surface_m, view_of
from peopleboy.tracker.rgbd.people.looks import BINS, bin_of_colour

_ROWS: Final = 24
_COLUMNS: Final = 11
_WIDE_M: Final = 0.4
_LOW_M: Final = 0.25  # above the floor, below which there are shoes and shadows
_REACH_M: Final = 0.3
_LEAST_IN_ROW: Final = 1  # own readings
_LEAST_ROWS: Final = 0.5  # share of the rows


def colours(place_m: Floats, tall_m: float, frame: Frame) -> Floats | None:
    """Give the histogram (BINS,) of the colours of somebody at a place (2,) in the robot's frame.

    What is nearer or farther is left out, and so are readings beside an edge. Every row of the body counts
    the same, however much of it something else covers, so that half a person looks like a whole one.

    Returns:
        None where too little of the person is seen, or there is no depth image.
    """
    view = view_of(frame)
    if view is None:
        return None
    left, top, width, height = shoulders(view, place_m, _WIDE_M, _LOW_M, tall_m)
    if width <= 0.0:
        return None
    depth, image = frame.depth(DEPTH), frame.rgb(DEPTH_COLOUR)
    u = np.rint(left + width * (np.arange(_COLUMNS) + 0.5) / _COLUMNS).astype(np.int64)
    v = np.rint(top + height * (np.arange(_ROWS) + 0.5) / _ROWS).astype(np.int64)
    u, v = u[(u >= 0) & (u < depth.shape[1])], v[(v >= 0) & (v < depth.shape[0])]
    own = np.abs(depth[np.ix_(v, u)] / 1000.0 - surface_m(view, place_m)) < _REACH_M
    inner = own.copy()
    inner[:, 1:] &= own[:, :-1]
    inner[:, :-1] &= own[:, 1:]
    counts = inner.sum(axis=1)
    is_seen = counts >= _LEAST_IN_ROW
    if is_seen.sum() < _LEAST_ROWS * _ROWS:
        return None
    inner &= is_seen[:, None]
    rows, columns = np.nonzero(inner)
    red, green, blue = (image[v[rows], u[columns]] >> 3).astype(np.int64).T
    bins = bin_of_colour()[(red << 10) | (green << 5) | blue]
    found = np.bincount(bins, 1.0 / counts[rows], minlength=BINS)
    return np.asarray(found / found.sum())
