"""Offsets that come as an uncooled camera warms up, and the shutter before which it gets rid of them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.noise import gaussian, smooth_gaussian
from peopleboy.sim.random_streams import stream

SMOOTH_SHARE: Final = 0.5
PIXEL_SHARE: Final = 0.1
"""Drift of the fixed pattern, alike over patches and pixel by pixel, over that of the common offset."""

_PATCHES: Final = 4  # to an image's height
_SOON_S: Final = 1e-6


class Drift:
    """The offsets of one run, by time alone.

    From one calibration to the next, every pixel drifts at a rate of its own; then it begins anew from 0 at
    another rate. What columns differ by is drawn anew at every calibration, too.

    Args:
        config: of the camera.
        name: of the camera, and of its streams.
        seed: of the run.
    """

    def __init__(self, config: ThermalConfig, name: str, seed: int) -> None:
        self._config, self._name, self._seed = config, name, seed
        self._is_on = config.offset_drift_k_per_min > 0.0 or config.column_noise_k > 0.0
        self._drawn = -1

    def is_closed(self, time_s: float) -> bool:
        """Tell whether the shutter is before the detector."""
        count = self._closures(time_s)
        since_s = time_s - count * self._config.shutter_every_s
        return count > 0 and since_s < self._config.shutter_lasts_s - _SOON_S

    def offset_k(self, time_s: float) -> NDArray[np.float32] | None:
        """Give the (H, W) offsets [K] at a time; None for none."""
        if not self._is_on:
            return None
        count = self._closures(time_s)
        if count != self._drawn:
            self._draw(count)
        calibrated_s = count * self._config.shutter_every_s + self._config.shutter_lasts_s if count else 0.0
        minutes = np.float32(max(time_s - calibrated_s, 0.0) / 60.0)
        return _drifted(self._columns, self._rate, minutes)

    def _closures(self, time_s: float) -> int:
        every = self._config.shutter_every_s
        return math.floor((time_s + _SOON_S) / every) if every > 0.0 else 0

    def _draw(self, count: int) -> None:
        """Draw the columns' offsets [K] and the pixels' rates [K/min] after some calibration."""
        config, rng = self._config, stream(self._seed, f"{self._name}.drift.{count}")
        height, width = config.camera.height, config.camera.width
        common = gaussian((1, 1), rng)
        smooth = smooth_gaussian((height, width), max(height // _PATCHES, 1), rng)
        pixel = gaussian((height, width), rng)
        rate = common + np.float32(SMOOTH_SHARE) * smooth + np.float32(PIXEL_SHARE) * pixel
        self._rate = np.float32(config.offset_drift_k_per_min) * rate
        self._columns = np.float32(config.column_noise_k) * gaussian((1, width), rng)
        self._drawn = count


@njit(cache=True)
def _drifted(
    columns: NDArray[np.float32], rate: NDArray[np.float32], minutes: np.float32
) -> NDArray[np.float32]:
    """Offsets (H, W) of columns (1, W), and of pixels that drift at a rate (H, W) for some minutes."""
    offset = np.empty_like(rate)
    for v in range(rate.shape[0]):
        for u in range(rate.shape[1]):
            offset[v, u] = columns[0, u] + minutes * rate[v, u]
    return offset
