"""Thermal images drawn by hand, whose right answer is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import THERMAL, Frame

BACKGROUND, WARM, RADIATOR = 10, 160, 255


def blank(height: int = 240, width: int = 320) -> NDArray[np.uint8]:
    return np.full((height, width), BACKGROUND, dtype=np.uint8)


def fill_ellipse(image: NDArray[np.uint8], x: float, y: float, a: float, b: float, grey: int = WARM) -> None:
    v, u = np.mgrid[: image.shape[0], : image.shape[1]]
    image[((u - x) / a) ** 2 + ((v - y) / b) ** 2 <= 1] = grey


def draw_person(image: NDArray[np.uint8], x: float, y: float, w: float, h: float, d: float = 0.0) -> None:
    """Draw body, head and two legs down to the thesis's box: 3.5 h below the top of the head."""
    fill_ellipse(image, x, y, w, h)
    fill_ellipse(image, x + d, y - h - h / 4.4, 0.75 * h / 4.4, h / 4.4)
    feet = round(y + 2.05 * h)
    for side in (-1, 1):
        leg = round(x + side * 0.4 * w)
        half = max(1, round(0.2 * w))
        image[round(y + 0.5 * h) : feet, leg - half : leg + half + 1] = WARM


def person_frame(time_s: float, x: float = 150.0, h: float = 28.0) -> Frame:
    image = blank()
    draw_person(image, x, 120 + 0.36 * h, 0.38 * h, h)
    return Frame(images={THERMAL: image}, time_s=time_s)
