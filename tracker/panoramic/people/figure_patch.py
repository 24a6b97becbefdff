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
    sums = np.empty((height + 1, wide + 1, LAYERS), np.float32)
    sums[0] = np.float32(0.0)
    for v in range(0, height, 2):
        _add_along(people, new, covered, sums, v, min(v + 1, height - 1))
    flat = sums.reshape(height + 1, -1)
    for v in range(height):
        above, here = flat[v], flat[v + 1]
        for x in range(len(here)):
            here[x] += above[x]
    return sums


@njit(cache=True, nogil=True)
def _add_along(people: Map, new: Map, covered: Map, sums: Map, one: int, other: int) -> None:
    """Add up two rows from the left on, as each step has to wait for the one before in its own row only."""
    width, zero, whole = people.shape[1], np.float32(0.0), np.float32(1.0)
    a0, b0, c0, a1, b1, c1 = zero, zero, zero, zero, zero, zero
    line0, line1 = sums[one + 1], sums[other + 1]
    line0[0], line1[0] = zero, zero
    u = width - 1 - (MARGIN_PX - 1) % width
    for x in range(1, len(line0)):
        known0, known1 = whole - covered[one, u], whole - covered[other, u]
        a0, a1 = a0 + people[one, u] * known0, a1 + people[other, u] * known1
        b0, b1 = b0 + new[one, u] * known0, b1 + new[other, u] * known1
        c0, c1 = c0 + known0, c1 + known1
        line0[x, PEOPLE], line0[x, NEW], line0[x, KNOWN] = a0, b0, c0
        line1[x, PEOPLE], line1[x, NEW], line1[x, KNOWN] = a1, b1, c1
        u = u + 1 if u + 1 < width else 0


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
def between(sums: Map, layer: int, left: float, right: float, top: float, bottom: float) -> float:
    """Add up a layer between corners, which may be inside pixels; columns count from the margin's first."""
    lower = _layer_at(sums, layer, right, bottom) - _layer_at(sums, layer, left, bottom)
    return float(lower - _layer_at(sums, layer, right, top) + _layer_at(sums, layer, left, top))


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


@njit(cache=True, nogil=True)
def _layer_at(sums: Map, layer: int, x: float, y: float) -> float:
    x = min(max(x, 0.0), sums.shape[1] - 1.0)
    y = min(max(y, 0.0), sums.shape[0] - 1.0)
    i, j = min(int(x), sums.shape[1] - 2), min(int(y), sums.shape[0] - 2)
    a, b = x - i, y - j
    upper = (1.0 - a) * sums[j, i, layer] + a * sums[j, i + 1, layer]
    lower = (1.0 - a) * sums[j + 1, i, layer] + a * sums[j + 1, i + 1, layer]
    return float((1.0 - b) * upper + b * lower)
