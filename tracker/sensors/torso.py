"""The torso of a person in the depth image, which arms and legs do not move."""

from typing import Final, NamedTuple

import numpy as np

from peopleboy.tracker.rgbd.depth_view import Depth
from peopleboy.tracker.rgbd.pre_detection import PreDetection

_TORSO_ROWS: Final = np.linspace(0.18, 0.5, 12)  # rows of the torso, in heights from the head down
_BESIDE: Final = 0.1  # in heights, searched to either side of an object
_TORSO_M: Final = 0.35  # from an object's depth, within which readings belong to it
_SIDE_PX: Final = 3  # columns beside a torso in which something nearer hides its side
_LEAST_ROWS: Final = 0.12  # least width of a torso, in heights
_MOST: Final = 0.5  # share of a column's readings that decides what it shows


class Torso(NamedTuple):
    """The torso of a person in the depth image: its middle column, and its width."""

    middle_px: float
    width_px: float


def find_torso(found: PreDetection, height_px: float, depth: Depth) -> Torso | None:
    """Find the torso of an object of a whole height [px] in a depth image.

    None if the object reaches the border of the image, if something nearer hides a side of it, or if it is
    narrower than a torso.
    """
    left, top, width, _ = found.box
    first, last = int(left - _BESIDE * height_px), int(left + width + _BESIDE * height_px)
    rows = np.rint(top + _TORSO_ROWS * height_px).astype(np.int64)
    rows = rows[(rows >= 0) & (rows < len(depth))]
    if first < 0 or last >= depth.shape[1] or len(rows) < len(_TORSO_ROWS) // 2:
        return None
    z_m = depth[rows, first : last + 1] / 1000.0
    own = np.flatnonzero((np.abs(z_m - found.z_m) < _TORSO_M).mean(axis=0) > _MOST)
    if not len(own):
        return None
    is_nearer = ((z_m > 0.0) & (z_m <= found.z_m - _TORSO_M)).mean(axis=0) > _MOST
    sides = is_nearer[max(own[0] - _SIDE_PX, 0) : own[-1] + 1 + _SIDE_PX]
    if sides.any() or len(own) < _LEAST_ROWS * height_px:
        return None
    return Torso(first + float(own.mean()), float(len(own)))
