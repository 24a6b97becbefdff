"""What the panorama shows where a person would stand: a small map in metres, the same at every distance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.panorama_calibration import PanoramaCalibration

Floats = NDArray[np.float64]
Map = NDArray[np.float32]

HALF_WIDTH_M: Final = 0.45
TOP_M: Final = 1.3
BOTTOM_M: Final = -0.35  # of the upright plane through the person, below which lies the floor before it
ACROSS: Final = 15
UP: Final = 22

PEOPLE, NEW, KNOWN = 0, 1, 2
LAYERS: Final = 3
"""Shares of a cell's pixels: on people, unlike the background, and not covered by somebody nearer."""

PATCH: Final = LAYERS * ACROSS * UP

MARGIN_PX: Final = 120
"""By how many columns sums go on beyond either side of the image."""


@dataclass(frozen=True, slots=True, eq=False)
class FigureMap:
    """What one panorama shows of people, ready to be asked at any place.

    Attributes:
        sums: (H + 1, W + 2 MARGIN_PX + 1, LAYERS) over the pixels above and left of each corner, around the
            seam; of a pixel that is covered nothing counts.
        calibration: of the camera.
    """

    sums: Map
    calibration: PanoramaCalibration

    @classmethod
    def build(cls, people: Map, new: Map, covered: Map, calibration: PanoramaCalibration) -> FigureMap:
        """Add up maps (H, W): how surely a pixel is on a person, unlike the background, and covered."""
        return cls(_summed(people, new, covered), calibration)

    def patches(self, bearing_rad: Floats, distance_m: Floats) -> Map:
        """Show (N, PATCH) what is seen at places on the floor, by their bearings and distances (N,)."""
        camera = self.calibration
        return _patches(
            self.sums,
            np.asarray(bearing_rad, np.float64),
            np.asarray(distance_m, np.float64),
            float(camera.width),
            float(camera.height),
            camera.focal_px,
            camera.axis_rad,
            camera.ring_radius_m,
            camera.ring_height_m,
        )


@njit(cache=True, nogil=True)
def _summed(people: Map, new: Map, covered: Map) -> Map:
    height, width = people.shape
    wide = width + 2 * MARGIN_PX
    sums = np.zeros((height + 1, wide + 1, LAYERS), np.float32)
    for v in range(height):
        so_far = np.zeros(LAYERS)
        u = width - MARGIN_PX % width
        for x in range(wide):
            if u >= width:
                u -= width
            known = 1.0 - covered[v, u]
            so_far[PEOPLE] += people[v, u] * known
            so_far[NEW] += new[v, u] * known
            so_far[KNOWN] += known
            for layer in range(LAYERS):
                sums[v + 1, x + 1, layer] = sums[v, x + 1, layer] + so_far[layer]
            u += 1
    return sums


@njit(cache=True, nogil=True)
def _patches(
    sums: Map,
    bearing: Floats,
    distance: Floats,
    width: float,
    height: float,
    focal: float,
    axis: float,
    ring_radius: float,
    ring_height: float,
) -> Map:
    found = np.empty((len(bearing), PATCH), np.float32)
    corners = np.empty((UP + 1, ACROSS + 1, LAYERS))
    for n in range(len(bearing)):
        middle = (0.5 - bearing[n] / math.tau) * width
        middle += MARGIN_PX - math.floor(middle / width) * width
        reach = math.atan2(HALF_WIDTH_M, distance[n]) / math.tau * width
        step = 2.0 * reach / ACROSS
        rows = np.empty(UP + 1)
        for j in range(UP + 1):
            z = TOP_M + (BOTTOM_M - TOP_M) * j / UP
            above = axis - math.atan2(ring_height - z, distance[n] - ring_radius)
            rows[j] = height - focal * math.tan(min(max(above, -1.4), 1.4))
            for i in range(ACROSS + 1):
                _at(sums, middle - reach + i * step, rows[j], corners[j, i])
        for j in range(UP):
            area = step * (rows[j + 1] - rows[j])
            for i in range(ACROSS):
                for layer in range(LAYERS):
                    upper = corners[j, i + 1, layer] - corners[j, i, layer]
                    lower = corners[j + 1, i + 1, layer] - corners[j + 1, i, layer]
                    found[n, (layer * UP + j) * ACROSS + i] = (lower - upper) / area
    return found


@njit(cache=True, nogil=True)
def between(sums: Map, left: float, right: float, top: float, bottom: float) -> Floats:
    """Add up (LAYERS,) what lies between corners, which may be inside pixels; the margin counts, too."""
    one, other = np.empty(LAYERS), np.empty(LAYERS)
    total = np.empty(LAYERS)
    _at(sums, right, bottom, total)
    _at(sums, left, bottom, one)
    total -= one
    _at(sums, right, top, one)
    _at(sums, left, top, other)
    return total - one + other


@njit(cache=True, nogil=True)
def _at(sums: Map, x: float, y: float, told: Floats) -> None:
    """Interpolate sums between corners; beyond the image nothing is added."""
    x = min(max(x, 0.0), sums.shape[1] - 1.0)
    y = min(max(y, 0.0), sums.shape[0] - 1.0)
    i, j = min(int(x), sums.shape[1] - 2), min(int(y), sums.shape[0] - 2)
    a, b = x - i, y - j
    for layer in range(LAYERS):
        upper = (1.0 - a) * sums[j, i, layer] + a * sums[j, i + 1, layer]
        lower = (1.0 - a) * sums[j + 1, i, layer] + a * sums[j + 1, i + 1, layer]
        told[layer] = (1.0 - b) * upper + b * lower
