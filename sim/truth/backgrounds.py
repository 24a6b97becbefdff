"""What stands behind everything that comes and goes: the depth that models of a scene are held against."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.truth.truth import Truth

Metres = NDArray[np.float32]

_STOOD_M = 1e-3  # a camera that moved or turned by less stands still
_STOOD_RAD = 1e-3


class Backgrounds:
    """The backgrounds of one camera, fed with the truths of its instants; a camera that moves starts anew.

    Attributes:
        clean: (H, W) [m] true depth without people and without what is moved.
        ever: (H, W) [m] farthest true depth shown so far: all that can be known of `clean`.
        frames: how many instants that is.
    """

    def __init__(self) -> None:
        self.clean: Metres | None = None
        self.ever: Metres | None = None
        self.frames = 0
        self._pose: Matrix | None = None

    def update(self, truth: Truth) -> None:
        """Take in one more instant."""
        if self.ever is None or not self._stands(truth.world_from_camera):
            self._pose = np.array(truth.world_from_camera)
            self.clean, self.ever, self.frames = truth.background_m(), np.array(truth.depth_m), 0
        else:
            self.ever = np.maximum(self.ever, truth.depth_m)
        self.frames += 1

    def _stands(self, pose: Matrix) -> bool:
        assert self._pose is not None
        moved = float(np.abs(pose[:3, 3] - self._pose[:3, 3]).max())
        return moved < _STOOD_M and float(np.abs(pose[:3, :3] - self._pose[:3, :3]).max()) < _STOOD_RAD
