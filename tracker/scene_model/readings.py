"""Preprocessing of depth images: smoothing, and per-pixel noise estimated from the image."""

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.scene_model.scene import Metres

Depth = NDArray[np.uint16]

_PATCH_PX = 7
_SD_OF_MEAN = np.float32(1.2533)  # standard deviation over mean absolute deviation of a Gaussian
_FEWEST = 4  # of 8 neighbours that must agree; at edges light of two surfaces mixes
_NEAR_M, _NEAR_SHARE, _NEAR_DEVIATIONS = 0.05, 0.03, 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """A depth image.

    Attributes:
        raw_m: (H, W) as read [m]; 0 for no reading.
        smooth_m: (H, W) median of the neighbours; 0 for no reading.
        is_mixed: (H, W) where light of several surfaces mixes, at edges.
        noise: (H, W) standard deviation of inverse depth [1/m].
        count: number of images of the noise estimate.
    """

    raw_m: Metres
    smooth_m: Metres
    is_mixed: NDArray[np.bool_]
    noise: Metres
    count: int

    @classmethod
    def of(cls, depth: Depth, before: "Readings | None", memory: float) -> "Readings":
        """Make it from an (H, W) depth image [mm].

        Args:
            depth: the image.
            before: the previous image of the same place; None at the start.
            memory: weight of its noise estimate.
        """
        raw = depth.astype(np.float32) / np.float32(1000.0)
        middle = cv2.medianBlur(depth, 3).astype(np.float32) / np.float32(1000.0)
        smooth = np.where((raw > 0.0) & (middle > 0.0), middle, raw)
        noise = _noise(raw, cv2.medianBlur(depth, 5).astype(np.float32) / np.float32(1000.0))
        if before is not None:
            noise = np.maximum(noise, _noise(raw, before.raw_m) / np.float32(np.sqrt(2.0)))
            kept = min(memory, 1.0 - 1.0 / before.count)  # the first one has no temporal noise
            noise = kept * before.noise + (1.0 - kept) * noise
        return cls(raw, smooth, _mixed(raw, noise), noise, 1 if before is None else before.count + 1)

    def reach_m(self, least_m: float, deviations: float, most_m: float) -> Metres:
        """Return (H, W) the tolerance between two readings of one surface [m]."""
        reach = deviations * self.noise * self.smooth_m**2
        return np.asarray(np.clip(reach, least_m, most_m), np.float32)


def _noise(raw_m: Metres, other_m: Metres) -> Metres:
    """Estimate the noise (H, W) [1/m] from differences of readings to their median, or to previous readings.

    Motion and edges have little effect: differences are clipped to the range of most of the image.
    """
    is_read = (raw_m > 0.0) & (other_m > 0.0)
    safe_raw, safe_other = (
        np.where(is_read, raw_m, np.float32(1.0)),
        np.where(is_read, other_m, np.float32(1.0)),
    )
    apart = np.abs(safe_raw - safe_other) / (safe_raw * safe_other)
    apart[~is_read] = 0.0
    sample = apart[::3, ::3][is_read[::3, ::3]]
    usual = float(np.quantile(sample, 0.7)) if sample.size else 0.0
    np.minimum(apart, np.float32(8.0 * usual + 1e-4), out=apart)
    level = float(np.minimum(sample, 3.0 * usual).mean()) if sample.size else 0.0
    size = (_PATCH_PX, _PATCH_PX)
    share = cv2.blur(is_read.astype(np.float32), size)
    mean = cv2.blur(apart, size) / np.maximum(share, np.float32(1e-3))
    return np.asarray(_SD_OF_MEAN * np.maximum(mean, np.float32(level)), np.float32)


@njit(cache=True, nogil=True)
def _mixed(raw, noise):  # type: ignore[no-untyped-def]
    """Return the readings with which too few neighbours agree."""
    height, width = raw.shape
    found = np.zeros((height, width), np.bool_)
    for v in range(height):
        for u in range(width):
            z = raw[v, u]
            if z <= 0.0:
                continue
            near = max(_NEAR_M, _NEAR_SHARE * z, _NEAR_DEVIATIONS * noise[v, u] * z * z)
            agreeing, there = 0, 0
            for row in range(max(v - 1, 0), min(v + 2, height)):
                for column in range(max(u - 1, 0), min(u + 2, width)):
                    there += 1
                    agreeing += abs(raw[row, column] - z) < near
            found[v, u] = agreeing - 1 < min(_FEWEST, (there - 1) // 2)
    return found
