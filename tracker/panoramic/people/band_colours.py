"""Appearance of a person: illumination-invariant mean colours of height bands."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.panoramic.people.figure_patch import Map

BANDS_M: Final = np.array([0.02, 0.3, 0.65, 1.0, 1.35])
"""Limits of the bands of height [m]."""

BANDS: Final = len(BANDS_M) - 1
_HALF_WIDTH_M: Final = 0.3
_LEAST_PX: Final = 6
_LEARNING: Final = 0.06
_SPREAD: Final = 0.055  # standard deviation of one person's colours between images


@dataclass(frozen=True, slots=True, eq=False)
class BandColours:
    """Mean colours of a person.

    Attributes:
        colours: (BANDS, 3) red, green, blue divided by the image's mean; NaN for a band not seen yet.
    """

    colours: Map

    def joined(self, newest: "BandColours") -> "BandColours":
        """Update with one more image."""
        grown = self.colours + _LEARNING * (newest.colours - self.colours)
        known = np.where(np.isnan(self.colours), newest.colours, self.colours)
        return BandColours(np.where(np.isnan(grown), known, grown).astype(np.float32))

    def unlikeness(self, other: "BandColours") -> float:
        """Return the mean squared difference of two people in standard deviations; NaN if none is common."""
        return float(_unlikeness(self.colours, other.colours))


@njit(cache=True, nogil=True)
def _unlikeness(colours: Map, others: Map) -> float:
    total, known = 0.0, 0
    for band in range(BANDS):
        for channel in range(3):
            own = colours[band, channel]
            away = (own - others[band, channel]) / (_SPREAD * (1.0 + own))
            if not math.isnan(away):
                total, known = total + away * away, known + 1
    return total / known if known > 0 else math.nan


NO_COLOURS: Final = BandColours(np.full((BANDS, 3), np.nan, np.float32))


def look_at(
    image: NDArray[np.uint8],
    foreground: Map,
    covered: Map,
    bearing_rad: float,
    distance_m: float,
    calibration: PanoramaCalibration,
) -> BandColours:
    """Describe the person at a bearing and a distance in an RGB panorama (H, W, 3).

    Only pixels count that are more likely foreground than not (foreground, (H, W)), and that no nearer person
    covers (H, W).
    """
    rows = _rows(distance_m, calibration)
    middle = (0.5 - bearing_rad / math.tau) * calibration.width - 0.5
    half = max(math.atan2(_HALF_WIDTH_M, distance_m) / math.tau * calibration.width, 1.0)
    sums = _sums(image, foreground, covered, rows, middle, half)
    light = max(float(image[::8, ::8].mean()), 1.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        colours = np.where(sums[:, 3:] >= _LEAST_PX, sums[:, :3] / sums[:, 3:] / light, np.nan)
    return BandColours(colours.astype(np.float32))


def _rows(distance_m: float, calibration: PanoramaCalibration) -> NDArray[np.float64]:
    return np.array([calibration.row(distance_m, height) for height in BANDS_M.tolist()])


@njit(cache=True, nogil=True)
def _sums(
    image: NDArray[np.uint8],
    foreground: Map,
    covered: Map,
    rows: NDArray[np.float64],
    middle: float,
    half: float,
) -> NDArray[np.float64]:
    height, width = foreground.shape
    sums = np.zeros((len(rows) - 1, 4))
    for band in range(len(rows) - 1):
        for v in range(max(math.ceil(rows[band + 1]), 0), min(math.ceil(rows[band]), height)):
            for u in range(math.ceil(middle - half), math.floor(middle + half) + 1):
                if foreground[v, u % width] > 0.5 and covered[v, u % width] < 0.5:
                    for channel in range(3):
                        sums[band, channel] += image[v, u % width, channel]
                    sums[band, 3] += 1.0
    return sums
