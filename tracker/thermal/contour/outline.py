"""From a contour to what people look at: its box, and its outline for drawing."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import BoxConfig, ContourConfig
from peopleboy.tracker.thermal.contour.contour import (
    FEET,
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

Box = tuple[float, float, float, float]


def box_of(ellipse: Ellipse, config: BoxConfig, head_divisor: float) -> Box:
    """Give the box left, top, width, height [px] of a contour.

    Its top is the top of the head, its centre column the body's.

    Source: thesis, section 3.4 (2 w by 3.5 h); paper, section 4.1 (2 w by 3 h).
    """
    width, height = config.width_per_w * ellipse.w, config.height_per_h * ellipse.h
    top = ellipse.y - (1 + 2 / head_divisor + config.hair_per_h) * ellipse.h
    return ellipse.x - width / 2, top, width, height


def outline(
    ellipse: Ellipse, config: ContourConfig, count: int = 48
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Give the outlines of body and head as two closed lines (count, 2) [px]."""
    angle = np.linspace(0.0, 2 * np.pi, count)
    nothing = np.zeros(count)
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    centre = np.array([ellipse.x, ellipse.y])
    return centre + body_points(angle, nothing, 0.0) @ mix, centre + head_points(
        angle, config, nothing, 0.0
    ) @ mix


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
            points[line] = head_points(angle, config, nothing, 0.0)
        else:
            points[line] = body_points(angle, nothing, 0.0)
    points[FEET, :, 0, 2] = np.linspace(-config.feet_span, config.feet_span, count)
    points[FEET, :, 1, 2] = config.feet_line
    points.setflags(write=False)
    return points
