"""Patches of the panorama at a person's position: small maps in metres, independent of the distance."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration

Floats = NDArray[np.float64]
Map = NDArray[np.float32]

HALF_WIDTH_M: Final = 0.45
TOP_M: Final = 1.3
BOTTOM_M: Final = -0.35  # lower end of the upright plane through the person, where the floor in front appears
ACROSS: Final = 15
UP: Final = 22

PEOPLE, NEW, KNOWN = 0, 1, 2
LAYERS: Final = 3
"""Layers of a cell, as shares of its pixels: foreground, novel, and not covered by a nearer person."""

PATCH: Final = LAYERS * ACROSS * UP


@dataclass(frozen=True, slots=True, eq=False)
class FigureMap:
    """Integral images of one panorama, from which patches at any position are computed.

    Attributes:
        sums: (H + 1, W + 1, LAYERS) over the pixels above and left of each corner, without covered pixels.
        calibration: of the camera.
    """

    sums: Map
    calibration: PanoramaCalibration

    @classmethod
    def build(cls, people: Map, new: Map, covered: Map, calibration: PanoramaCalibration) -> "FigureMap":
        """Integrate maps (H, W): foreground probability, novelty, and covered pixels."""
        return cls(_summed(people, new, covered), calibration)

    def patches(self, bearing_rad: Floats, distance_m: Floats) -> Map:
        """Return patches (N, PATCH) at positions on the floor, by their bearings and distances (N,)."""
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


@njit(cache=True, nogil=True, fastmath={"contract"})
def _summed(people: Map, new: Map, covered: Map) -> Map:
    height, width = people.shape
    sums = np.zeros((height + 1, width + 1, LAYERS), np.float32)
    columns = np.zeros((LAYERS, width), np.float32)
    for v in range(height):
        for u in range(width):
            known = np.float32(1.0) - covered[v, u]
            columns[PEOPLE, u] += people[v, u] * known
            columns[NEW, u] += new[v, u] * known
            columns[KNOWN, u] += known
        for u in range(width):
            for layer in range(LAYERS):
                sums[v + 1, u + 1, layer] = sums[v + 1, u, layer] + columns[layer, u]
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
        reach = math.atan2(HALF_WIDTH_M, distance[n]) / math.tau * width
        step = 2.0 * reach / ACROSS
        rows = np.empty(UP + 1)
        for j in range(UP + 1):
            z = TOP_M + (BOTTOM_M - TOP_M) * j / UP
            above = axis - math.atan2(ring_height - z, distance[n] - ring_radius)
            rows[j] = height - focal * math.tan(min(max(above, -1.4), 1.4))
            for i in range(ACROSS + 1):
                for layer in range(LAYERS):
                    corners[j, i, layer] = _layer_at(sums, layer, middle - reach + i * step, rows[j])
        for j in range(UP):
            area = max(step * (rows[j + 1] - rows[j]), 1e-9)  # rows far outside coincide
            for i in range(ACROSS):
                for layer in range(LAYERS):
                    upper = corners[j, i + 1, layer] - corners[j, i, layer]
                    lower = corners[j + 1, i + 1, layer] - corners[j + 1, i, layer]
                    found[n, (layer * UP + j) * ACROSS + i] = (lower - upper) / area
    return found


@njit(cache=True, nogil=True)
def between(sums: Map, layer: int, left: float, right: float, top: float, bottom: float) -> float:
    """Sum a layer between corners, which may be inside pixels and beyond the seam."""
    lower = _layer_at(sums, layer, right, bottom) - _layer_at(sums, layer, left, bottom)
    return float(lower - _layer_at(sums, layer, right, top) + _layer_at(sums, layer, left, top))


@njit(cache=True, nogil=True)
def _layer_at(sums: Map, layer: int, x: float, y: float) -> float:
    """Interpolate a layer's sum between corners, constant above and below the image."""
    width = sums.shape[1] - 1
    turns = math.floor(x / width)
    x -= turns * width
    y = min(max(y, 0.0), sums.shape[0] - 1.0)
    i, j = min(int(x), width - 1), min(int(y), sums.shape[0] - 2)
    a, b = x - i, y - j
    upper = (1.0 - a) * sums[j, i, layer] + a * sums[j, i + 1, layer] + turns * sums[j, width, layer]
    lower = (1.0 - a) * sums[j + 1, i, layer] + a * sums[j + 1, i + 1, layer]
    lower += turns * sums[j + 1, width, layer]
    return float((1.0 - b) * upper + b * lower)
