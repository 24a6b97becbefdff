"""The outline of a contour, for drawing."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import ContourConfig
from peopleboy.tracker.thermal.contour.contour import (
    FEET,
    FEET_SPAN,
    HEAD_LEFT,
    HEAD_RIGHT,
    HEAD_TOP,
    SECTIONS,
    SIDE_RIGHT,
    body_points,
    head_points,
    section_angles,
)
from peopleboy.tracker.thermal.ellipse import Ellipse
from peopleboy.tracker.thermal.particles import FOOT


def outline(ellipse: Ellipse, count: int = 48) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give the outlines of body and head as two closed lines (count, 2) [px]."""
    angle = np.linspace(0.0, 2 * np.pi, count)
    nothing = np.zeros(count)
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    centre = np.array([ellipse.x, ellipse.y])
    return centre + body_points(angle, nothing, 0.0) @ mix, centre + head_points(angle, nothing, 0.0) @ mix


def section_lines(ellipse: Ellipse, config: ContourConfig) -> NDArray[np.float64]:
    """Give a line (9, K, 2) [px] along every section, in their order with the feet, and one round the hips.

    The last one closes the body's ellipse, where no section is.
    """
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    lines: NDArray[np.float64] = _section_points(config) @ mix + (ellipse.x, ellipse.y)
    return lines


@lru_cache(maxsize=8)
def _section_points(config: ContourConfig, count: int = 5) -> NDArray[np.float64]:
    """Mix d, w, h and 1 to the points (9, count, 2, 4) of `section_lines`, from the body's centre."""
    points, nothing = np.zeros((SECTIONS + 1, count, 2, 4)), np.zeros(count)
    arcs = section_angles(config)
    side_end = arcs[SIDE_RIGHT][1]
    for line, (start, end) in {**arcs, SECTIONS: (side_end, 2.0 * np.pi - side_end)}.items():
        angle = np.linspace(start, end, count)
        if line in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT):
            points[line] = head_points(angle, nothing, 0.0)
        else:
            points[line] = body_points(angle, nothing, 0.0)
    points[FEET, :, 0, 2] = np.linspace(-FEET_SPAN, FEET_SPAN, count)
    points[FEET, :, 1, 2] = FOOT
    points.setflags(write=False)
    return points
