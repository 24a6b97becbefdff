"""Which frames have a new image of a camera: it may be missing, or stand still."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Frame, Odometry


class FreshImages:
    """Watches one camera.

    Args:
        camera: its name.
    """

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._last: NDArray[Any] | None = None
        self._way: Odometry | None = Odometry()

    def of(self, frame: Frame) -> Frame | None:
        """Give a frame whose odometry counts from the camera's last image on; None without a new image.

        An image equal to the last one is no new one: the noise of a camera never repeats.
        """
        self._way = joined(self._way, frame.odometry)
        image = frame.images.get(self._camera)
        if image is None or (self._last is not None and np.array_equal(image, self._last)):
            return None
        way, self._way, self._last = self._way, Odometry(), image
        return replace(frame, odometry=way)


def joined(first: Odometry | None, then: Odometry | None) -> Odometry | None:
    """Give the motion that two after each other make; None if one is unknown."""
    if first is None or then is None:
        return None
    cosine, sine = math.cos(first.turn_rad), math.sin(first.turn_rad)
    return Odometry(
        advance_m=first.advance_m + cosine * then.advance_m - sine * then.aside_m,
        aside_m=first.aside_m + sine * then.advance_m + cosine * then.aside_m,
        turn_rad=math.remainder(first.turn_rad + then.turn_rad, math.tau),
    )
