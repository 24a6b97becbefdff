"""Where in the panorama people may be whom nobody tracks yet."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np
from numba import njit

from peopleboy.tracker.panorama_calibration import PanoramaCalibration
from peopleboy.tracker.panoramic.people.figure_patch import (
    KNOWN,
    PEOPLE,
    FigureMap,
    Floats,
    Map,
    between,
)

NEAREST_M: Final = 1.1
FARTHEST_M: Final = 7.5
_RINGS: Final = np.geomspace(NEAREST_M, FARTHEST_M, 12)
_BEARINGS: Final = np.linspace(-math.pi, math.pi, 160, endpoint=False)
_LEAST: Final = 0.25
_APART_RAD: Final = math.radians(8.0)

# Limits of a standing body, of the floor before its feet, and of what is beside it [m]: to the left, to the
# right, from, up to.
_PARTS_M: Final = np.array(
    [(0.15, -0.15, 0.05, 1.2), (0.25, -0.25, -0.35, -0.1), (0.5, 0.3, 0.05, 1.2), (-0.3, -0.5, 0.05, 1.2)]
)
_LEAST_KNOWN: Final = 0.3
_LITTLE: Final = 0.1


def promising_places(figures: FigureMap, most: int) -> Floats:
    """Find up to so many bearings [rad] and distances [m], (N, 2), at which a body stands alone."""
    bearings, distances, parts = _grid(figures.calibration)
    worth = _worth(figures.sums, parts)
    found: list[int] = []
    while len(found) < most:
        best = int(np.argmax(worth))
        if worth[best] < _LEAST:
            break
        found.append(best)
        away = np.abs(np.remainder(bearings - bearings[best] + math.pi, math.tau) - math.pi)
        worth[away < _APART_RAD] = 0.0
    return np.stack([bearings[found], distances[found]], axis=1)


@lru_cache(maxsize=8)
def _grid(calibration: PanoramaCalibration) -> tuple[Floats, Floats, Floats]:
    """Give bearings (N,), distances (N,), and (N, 4, 4) left, right, top, bottom [px] of the parts."""
    bearings, distances = np.tile(_BEARINGS, len(_RINGS)), np.repeat(_RINGS, len(_BEARINGS))
    width = calibration.width
    middle = np.remainder((0.5 - bearings / math.tau) * width, width)
    parts = np.empty((len(bearings), len(_PARTS_M), 4))
    for part, (left, right, low, high) in enumerate(_PARTS_M):
        parts[:, part, 0] = middle - np.arctan2(left, distances) / math.tau * width
        parts[:, part, 1] = middle - np.arctan2(right, distances) / math.tau * width
        parts[:, part, 2] = np.maximum(_row(distances, high, calibration), 0.0)
        parts[:, part, 3] = np.minimum(_row(distances, low, calibration), calibration.height)
    return bearings, distances, parts


def _row(distance_m: Floats, height_m: float, calibration: PanoramaCalibration) -> Floats:
    places = np.stack([distance_m, np.zeros_like(distance_m), np.full_like(distance_m, height_m)], axis=1)
    return calibration.project(places)[:, 1] + 0.5


@njit(cache=True, nogil=True)
def _worth(sums: Map, parts: Floats) -> Floats:
    """Rate places: a body counts for, what lies before its feet and beside it against; 0 if there is none."""
    worth = np.empty(len(parts))
    shares = np.empty(4)
    for n in range(len(parts)):
        shares[:] = 0.0
        worth[n] = 0.0
        for part in range(4):
            if part == 1 and shares[0] < _LEAST:  # all else only counts against
                break
            left, right, top, bottom = parts[n, part]
            if bottom - top < 0.5:  # outside the image
                continue
            area = (right - left) * (bottom - top)
            seen = between(sums, PEOPLE, left, right, top, bottom) / area
            if part == 0 and seen < _LEAST * _LITTLE:  # too few to be somebody, whatever is known
                continue
            known = between(sums, KNOWN, left, right, top, bottom) / area
            if part > 0 or known > _LEAST_KNOWN:
                shares[part] = seen / max(known, _LITTLE)
        else:
            worth[n] = shares[0] - shares[1] - 0.25 * (shares[2] + shares[3])
    return worth
