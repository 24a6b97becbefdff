"""Depth images made ready: smoothed for decisions, with the noise of each pixel estimated from the image."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from peopleboy.tracker.rgbd.detection.depth_view import Depth
from peopleboy.tracker.scene_model.scene import Metres

_PATCH_PX = 7
_SD_OF_MEAN = 1.2533  # standard deviation over mean absolute deviation of a Gaussian
_OWN_SHARE = 1.1  # noise over what is left of it beside its own median


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """A depth image.

    Attributes:
        raw_m: (H, W) as read [m]; 0 for none.
        smooth_m: (H, W) median of the neighbours; 0 where nothing is read.
        noise: (H, W) standard deviation of inverse depth [1/m].
    """

    raw_m: Metres
    smooth_m: Metres
    noise: Metres

    @classmethod
    def of(cls, depth: Depth, before: Metres | None, memory: float) -> Readings:
        """Read an (H, W) depth image [mm].

        Args:
            depth: the image.
            before: the noise as estimated until now; None at the start.
            memory: share of it that is kept.
        """
        raw = depth.astype(np.float32) / np.float32(1000.0)
        middle = cv2.medianBlur(depth, 3).astype(np.float32) / np.float32(1000.0)
        smooth = np.where((raw > 0.0) & (middle > 0.0), middle, raw)
        noise = _noise(raw, cv2.medianBlur(depth, 5).astype(np.float32) / np.float32(1000.0))
        return cls(raw, smooth, noise if before is None else memory * before + (1.0 - memory) * noise)

    def reach_m(self, least_m: float, deviations: float, most_m: float) -> Metres:
        """Give (H, W) how far two readings of one surface may be apart [m]."""
        return np.clip(deviations * self.noise * self.smooth_m**2, least_m, most_m).astype(np.float32)


def _noise(raw_m: Metres, middle_m: Metres) -> Metres:
    """Estimate the noise (H, W) [1/m] by what the median takes away; edges, which it keeps, hardly count."""
    is_read = (raw_m > 0.0) & (middle_m > 0.0)
    safe_raw, safe_middle = np.where(is_read, raw_m, 1.0), np.where(is_read, middle_m, 1.0)
    apart = np.abs(safe_raw - safe_middle) / (safe_raw * safe_middle)
    level = float(np.median(apart[is_read])) if is_read.any() else 0.0
    apart = np.minimum(apart, 12.0 * level + 1e-4)
    size = (_PATCH_PX, _PATCH_PX)
    share = cv2.blur(is_read.astype(np.float32), size)
    mean = cv2.blur(apart * is_read, size) / np.maximum(share, 1e-3)
    return np.asarray(_SD_OF_MEAN * _OWN_SHARE * np.maximum(mean, level), np.float32)
