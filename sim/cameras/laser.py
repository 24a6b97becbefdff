"""Formation of laser scans, and their display."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import LaserConfig
from peopleboy.sim.cameras.depth import Millimetres, show_depth, to_millimetres
from peopleboy.sim.cameras.imaging.noise import gaussian

_STRIP_ROWS: Final = 24  # height of a scan that is shown as an image


def measure_ranges(
    depth_m: NDArray[np.float32], config: LaserConfig, rng: np.random.Generator
) -> Millimetres:
    """Measure ranges (1, N) [mm] with noise; 0 outside the range of the sensor, and where no beam returns."""
    noise = np.float32(config.noise_m) * gaussian(depth_m.shape, rng) if config.is_noisy else np.float32(0.0)
    return to_millimetres(depth_m + noise, config)


def show_scan(ranges: Millimetres) -> NDArray[np.uint8]:
    """Convert a scan (1, N) to an RGB strip (24, N, 3) with the colours of depth images."""
    return np.repeat(show_depth(ranges), _STRIP_ROWS, axis=0)
