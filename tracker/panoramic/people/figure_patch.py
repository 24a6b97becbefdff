"""What the panorama shows where a person would stand: a small map in metres, the same at every distance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import cv2
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
PATCH: Final = 2 * ACROSS * UP
"""Numbers of a patch: in each cell the share of pixels on people, and the share that can be told."""

MARGIN_PX: Final = 120
"""By how many columns sums go on beyond either side of the image."""


@dataclass(frozen=True, slots=True, eq=False)
class FigureMap:
    """Where people are in one panorama, ready to be asked at any place.

    Attributes:
        people: (H + 1, W + 2 M + 1) sums above and left of each corner of pixels on people, around the seam.
        known: likewise of pixels that nobody nearer covers.
        calibration: of the camera.
    """

    people: Floats
    known: Floats
    calibration: PanoramaCalibration

    @classmethod
    def build(cls, foreground: Map, covered: Map, calibration: PanoramaCalibration) -> FigureMap:
        """Add up maps (H, W): how surely a pixel is on a person, and how surely somebody nearer is there."""
        known = 1.0 - covered
        return cls(_sums(foreground * known), _sums(known), calibration)

    def patches(self, bearing_rad: Floats, distance_m: Floats) -> Map:
        """Show (N, PATCH) what is seen at places on the floor, by their bearings and distances (N,)."""
        camera = self.calibration
        return _patches(
            self.people,
            self.known,
            np.asarray(bearing_rad, np.float64),
            np.asarray(distance_m, np.float64),
            float(camera.width),
            float(camera.height),
            camera.focal_px,
            camera.axis_rad,
            camera.ring_radius_m,
            camera.ring_height_m,
        )


def _sums(image: Map) -> Floats:
    wrapped = cv2.copyMakeBorder(image, 0, 0, MARGIN_PX, MARGIN_PX, cv2.BORDER_WRAP)
    return np.asarray(cv2.integral(wrapped), np.float64)


@njit(cache=True, nogil=True)
def _patches(
    people: Floats,
    known: Floats,
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
    columns, rows = np.empty(ACROSS + 1), np.empty(UP + 1)
    for n in range(len(bearing)):
        middle = (0.5 - bearing[n] / math.tau) * width
        middle -= math.floor(middle / width) * width
        reach = math.atan2(HALF_WIDTH_M, distance[n]) / math.tau * width
        for i in range(ACROSS + 1):
            columns[i] = middle + reach * (2.0 * i / ACROSS - 1.0) + MARGIN_PX
        for j in range(UP + 1):
            z = TOP_M + (BOTTOM_M - TOP_M) * j / UP
            above = axis - math.atan2(ring_height - z, distance[n] - ring_radius)
            rows[j] = height - focal * math.tan(min(max(above, -1.4), 1.4))
        for j in range(UP):
            for i in range(ACROSS):
                area = (columns[i + 1] - columns[i]) * (rows[j + 1] - rows[j])
                cell = j * ACROSS + i
                told = between(known, columns[i], columns[i + 1], rows[j], rows[j + 1])
                seen = between(people, columns[i], columns[i + 1], rows[j], rows[j + 1])
                found[n, cell] = seen / area
                found[n, ACROSS * UP + cell] = told / area
    return found


@njit(cache=True, nogil=True)
def between(sums: Floats, left: float, right: float, top: float, bottom: float) -> float:
    """Add up what lies between corners, which may lie inside pixels; columns count from the margin's."""
    lower = _at(sums, right, bottom) - _at(sums, left, bottom)
    return float(lower - _at(sums, right, top) + _at(sums, left, top))


@njit(cache=True, nogil=True)
def _at(sums: Floats, x: float, y: float) -> float:
    """Interpolate sums between corners; beyond the image nothing is added."""
    x = min(max(x, 0.0), sums.shape[1] - 1.0)
    y = min(max(y, 0.0), sums.shape[0] - 1.0)
    i, j = min(int(x), sums.shape[1] - 2), min(int(y), sums.shape[0] - 2)
    a, b = x - i, y - j
    upper = (1.0 - a) * sums[j, i] + a * sums[j, i + 1]
    lower = (1.0 - a) * sums[j + 1, i] + a * sums[j + 1, i + 1]
    return float((1.0 - b) * upper + b * lower)
