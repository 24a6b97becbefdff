"""Guided search: locate a person in the depth image near the predicted position."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import DEPTH, Floats, Frame
from peopleboy.tracker.sensors.depth.depth_visibility import BODY_M, shoulders, surface_m, view_of, warm_share

_LOW_M: Final = 0.8  # above the floor; legs spread below
_HIGH: Final = 0.92  # share of the height up to which there are shoulders
_ROWS: Final = 12
_COLUMNS: Final = 25
_HALF: Final = 1.25  # searched range to either side of the middle, in widths
_REACH_M: Final = 0.35
_DECIDES: Final = 0.5  # share of a column's readings that decides its owner
_LEAST_WIDE: Final = 0.15  # least visible width,
_WHOLE: Final = 0.6  # and that of an unoccluded person, in widths
_WIDEST: Final = 1.5  # greatest width of one person, in widths
_FARTHEST: Final = 0.8  # greatest distance from the prediction, in widths


@dataclass(frozen=True, slots=True, eq=False)
class GuidedMeasurement:
    """Measurement of a person in the depth image.

    Attributes:
        place_m: (2,) forward, left in the robot frame [m].
        warm: share of warm pixels; None if they are not in the thermal image.
    """

    place_m: Floats
    warm: float | None


@dataclass(frozen=True, slots=True, eq=False)
class _Columns:
    """Columns of pixels across the shoulders of a person, and what each shows.

    Attributes:
        u: (N,) [px] from left to right.
        v: (M,) rows [px].
        z_m: (M, N) depths.
        own: (M, N) whether a reading may belong to the person.
        is_own, is_near: (N,) whether most readings of a column belong to the person, or to something nearer.
    """

    u: NDArray[np.int64]
    v: NDArray[np.int64]
    z_m: Floats
    own: NDArray[np.bool_]
    is_own: NDArray[np.bool_]
    is_near: NDArray[np.bool_]


def search_near(place_m: Floats, wide_m: float, tall_m: float, frame: Frame) -> GuidedMeasurement | None:
    """Locate the middle of a person's shoulders from their unoccluded sides.

    A side next to a nearer object is not the person's side: then the middle is half a width from the other
    side.

    Args:
        place_m: (2,) forward, left in the robot frame [m], the predicted position.
        wide_m: width of the person.
        tall_m: height of the person.
        frame: with or without a depth image.

    Returns:
        None if the person cannot be located.
    """
    view = view_of(frame)
    if view is None:
        return None
    left, top, width, height = shoulders(view, place_m, wide_m, _LOW_M, _HIGH * tall_m)
    expected = left + width / 2.0
    columns = _columns(expected, width, (top, height), surface_m(view, place_m), frame)
    run = None if columns is None else _longest(columns.is_own)
    if columns is None or run is None:
        return None
    middle = _middle(columns, run, width)
    if middle is None or abs(middle - expected) > _FARTHEST * width:
        return None
    rows, across = np.nonzero(columns.own[:, run[0] : run[1] + 1])
    z_m = columns.z_m[rows, run[0] + across]
    pixels = np.stack([columns.u[run[0] + across], columns.v[rows]], axis=1)
    deep = float(np.median(z_m)) + BODY_M
    aside = (middle - view.centre_u) / view.focal_px * deep
    there = view.on_floor(np.array([aside]), np.array([deep]))[0]
    return GuidedMeasurement(np.asarray(there), warm_share(pixels, z_m, frame))


def _columns(
    middle: float, width: float, rows: tuple[float, float], surface: float, frame: Frame
) -> _Columns | None:
    depth = frame.depth(DEPTH)
    u = np.rint(middle + width * _HALF * np.linspace(-1.0, 1.0, _COLUMNS)).astype(np.int64)
    v = np.rint(rows[0] + rows[1] * (np.arange(_ROWS) + 0.5) / _ROWS).astype(np.int64)
    u, v = u[(u >= 0) & (u < depth.shape[1])], v[(v >= 0) & (v < depth.shape[0])]
    if width <= 0.0 or len(u) < 3 or len(v) < 3:
        return None
    z_m = depth[np.ix_(v, u)] / 1000.0
    own = np.abs(z_m - surface) < _REACH_M
    near = (z_m > 0.0) & (z_m <= surface - _REACH_M)
    readings = np.maximum((z_m > 0.0).sum(axis=0), 1)
    is_own, is_near = (part.sum(axis=0) / readings > _DECIDES for part in (own, near))
    return _Columns(u, v, z_m, own, is_own, is_near)


def _middle(columns: _Columns, run: tuple[int, int], width: float) -> float | None:
    """Return the middle column [px] of a person of a known width [px], given the visible run of columns."""
    u, (first, last) = columns.u, run
    step = (u[-1] - u[0]) / (len(u) - 1)
    starts, ends = float(u[first] - step / 2.0), float(u[last] + step / 2.0)
    seen = (ends - starts) / width
    if not _LEAST_WIDE <= seen <= _WIDEST:
        return None
    is_left = first > 0 and not columns.is_near[first - 1]
    is_right = last < len(u) - 1 and not columns.is_near[last + 1]
    if is_left and is_right:
        return (starts + ends) / 2.0 if seen >= _WHOLE else None
    half = max(width, ends - starts) / 2.0
    if is_left or is_right:
        return starts + half if is_left else ends - half
    return None


def _longest(flags: NDArray[np.bool_]) -> tuple[int, int] | None:
    """Return the first and last index of the longest run, ignoring gaps of one."""
    closed = flags.copy()
    closed[1:-1] |= flags[:-2] & flags[2:]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], closed, [False]]).astype(np.int8)))
    if len(edges) == 0:
        return None
    starts, ends = edges[::2], edges[1::2]
    best = int(np.argmax(ends - starts))
    return int(starts[best]), int(ends[best]) - 1
