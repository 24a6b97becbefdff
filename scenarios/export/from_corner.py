"""Pixels counted from the image's corner, as COCO and YOLO do, and not from the middle of the first pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from peopleboy.sim.truth.truth import Box

CORNER_PX: Final = 0.5
SEEN, HIDDEN, OUTSIDE = 2, 1, 0  # of keypoints, in both

Keypoint = tuple[float, float, int]


def from_corner(box: Box | None) -> list[float] | None:
    """Count a box's pixels from the image's corner, to a thousandth."""
    if box is None:
        return None
    left, top, width, height = box
    return [round(edge, 3) for edge in (left + CORNER_PX, top + CORNER_PX, width, height)]


def keypoints_from_corner(
    joints_px: Sequence[Sequence[float]], is_visible: Sequence[bool], size: tuple[int, int]
) -> list[Keypoint]:
    """Give u, v and 2 for a joint that is seen, 1 for a hidden one, and zeros for one outside the image.

    Args:
        joints_px: (17, 2) u, v from the middle of the first pixel; NaN behind the camera.
        is_visible: (17,) whether each is seen.
        size: width and height of the image [px].
    """
    width, height = size
    found: list[Keypoint] = []
    for (u, v), is_seen in zip(joints_px, is_visible, strict=True):
        is_inside = -CORNER_PX < u < width - CORNER_PX and -CORNER_PX < v < height - CORNER_PX
        point = (round(u + CORNER_PX, 3), round(v + CORNER_PX, 3), SEEN if is_seen else HIDDEN)
        found.append(point if is_inside else (0.0, 0.0, OUTSIDE))
    return found
