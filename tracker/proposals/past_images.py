"""The images of the last half second, which tell what moves in the newest one."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

import numpy as np

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.proposals.motion import Grey, change, shifted, turned

EARLIER_S: Final = 0.2
"""Age of the image that the present one is compared with."""

_OLDEST_S: Final = 2.5 * EARLIER_S


class _Past(NamedTuple):
    grey: Grey
    time_s: float
    heading_rad: float
    is_known: bool  # how the robot turned since the image before


class PastImages:
    """Images of one camera that come one after another."""

    def __init__(self) -> None:
        self._past: deque[_Past] = deque()

    def keep(self, grey: Grey, time_s: float, odometry: Odometry | None = None) -> None:
        """Take in the next one.

        Args:
            grey: (H, W); one of another size begins anew, and so does one that is not later.
            time_s: when it was taken.
            odometry: how the robot moved since the last one; None if that is not known.
        """
        past = self._past
        if past and (past[-1].time_s >= time_s or past[-1].grey.shape != grey.shape):
            past.clear()
        heading = past[-1].heading_rad if past else 0.0
        turn_rad = odometry.turn_rad if odometry is not None else 0.0
        past.append(_Past(grey.copy(), time_s, heading + turn_rad, odometry is not None))
        while time_s - past[0].time_s > _OLDEST_S:
            past.popleft()

    def change(self, mount: Mount | None = None) -> Grey:
        """Give by how much the last one (H, W) differs from that of about 0.2 s before; 0 if there is none.

        Args:
            mount: of the camera, with which odometry tells how pixels moved; without, the images do.
        """
        *earlier, now = self._past
        if not earlier:
            return np.zeros_like(now.grey)
        before = min(earlier, key=lambda one: abs(now.time_s - one.time_s - EARLIER_S))
        since = [one for one in self._past if one.time_s > before.time_s]
        if mount is not None and all(one.is_known for one in since):
            moved = turned(mount, now.grey.shape, now.heading_rad - before.heading_rad)
        else:
            moved = shifted(before.grey, now.grey)
        return change(before.grey, now.grey, moved)
