"""Which pixels of the panorama are people, image after image."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Calibration, Odometry
from peopleboy.tracker.panoramic.foreground.floor_rows import floor_rows
from peopleboy.tracker.panoramic.foreground.memory import first_memory, learn, move_along, unlikeness

Linear = NDArray[np.float32]


class Foreground:
    """Tells people from background, on a robot that stands or drives.

    It works from the first image on, whoever is in it.
    """

    def __init__(self) -> None:
        self._memory: Linear | None = None
        self._time_s = 0.0

    def update(
        self,
        image: NDArray[np.uint8],
        time_s: float,
        odometry: Odometry | None,
        calibration: Calibration,
    ) -> Linear:
        """Take in an image, and tell people from background.

        Args:
            image: (H, W, 3) uint8 RGB panorama.
            time_s: when it was taken [s].
            odometry: how the robot moved since the last image; None if unknown, which makes all begin anew.
            calibration: of the panoramic camera.

        Returns:
            (H, W) for each pixel the probability that it is a person.
        """
        floor = floor_rows(calibration, image.shape[0])
        passed_s = max(time_s - self._time_s, 0.01)
        if self._memory is None or odometry is None or self._memory.shape[:2] != image.shape[:2]:
            self._memory = first_memory(image)
        else:
            self._memory = move_along(self._memory, odometry, floor)
        memory, self._time_s = self._memory, time_s
        unlike, known_s = unlikeness(image, memory), memory[..., 4]
        told = np.asarray(known_s / (known_s + 0.3) / (1.0 + np.exp(4.0 - unlike)), np.float32)
        learn(memory, image, told, passed_s)
        return told
