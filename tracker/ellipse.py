"""From a contour to what people look at: its box, and its outline for drawing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracker.config import BoxConfig, ContourConfig
from tracker.contour import (
    FEET,
    HEAD_LEFT,
    HEAD_RIGHT,
    HEAD_TOP,
    body_points,
    head_points,
    section_angles,
)
from tracker.track import Ellipse

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


def section_lines(ellipse: Ellipse, config: ContourConfig, count: int = 6) -> list[NDArray[np.float64]]:
    """Give a line (count, 2) [px] along every section, in their order, the last one under the feet."""
    mix = np.array([ellipse.d, ellipse.w, ellipse.h, 1.0])
    centre, nothing = np.array([ellipse.x, ellipse.y]), np.zeros(count)
    lines = []
    for section, (start, end) in sorted(section_angles(config).items()):
        angle = np.linspace(start, end, count)
        is_head = section in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT)
        points = head_points(angle, config, nothing, 0.0) if is_head else body_points(angle, nothing, 0.0)
        lines.append(centre + points @ mix)
    assert len(lines) == FEET
    across = np.linspace(-config.feet_span, config.feet_span, count)
    feet = np.stack([across, np.full(count, config.feet_line)], axis=1) * ellipse.h
    return [*lines, centre + feet]
