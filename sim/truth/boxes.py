"""Boxes of the truth, made from edges, and held against an image.

A box is left, top, width, height [px] in the camera's image, whose pixel (0, 0) spans -0.5..0.5; bounds are
left, top, right, bottom [px], all NaN where nothing is before the camera.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from peopleboy.sim.geometry.camera_geometry import CameraGeometry

Box = tuple[float, float, float, float]
Edges = Sequence[float]


def box_between(bounds: Edges) -> Box | None:
    """Return the box with these bounds; None where nothing is before the camera."""
    left, top, right, bottom = bounds
    return None if math.isnan(left + top) else (left, top, right - left, bottom - top)


def box_of_pixels(first_u: float, last_u: float, first_v: float, last_v: float) -> Box:
    """Return the box that spans whole pixels, first to last column and row included."""
    return (first_u - 0.5, first_v - 0.5, last_u - first_u + 1.0, last_v - first_v + 1.0)


def is_cut_off(bounds: Edges, camera: CameraGeometry) -> bool:
    """Tell whether something with these bounds reaches beyond the image's border."""
    left, top, right, bottom = bounds
    return left <= -0.5 or top <= -0.5 or right >= camera.width - 0.5 or bottom >= camera.height - 0.5
