"""One panorama, processed from the nearest person to the farthest."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.tracker.sensors.panorama.figure_patch import (
    KNOWN,
    PEOPLE,
    FigureMap,
    Floats,
    Map,
    between,
)
from peopleboy.tracker.track import Box

_OUTLINE_M: Final = ((0.42, -0.2), (0.4, 0.3), (0.28, 0.7), (0.28, 2.0))
"""Half widths of the area that a person can cover, by height [m]: legs spread, the rest does not."""

_TRUNK: Final = 2
"""Index from which the body is in one piece, so that a gap is its end."""

BODY_M: Final = (0.5, 1.72)
"""Width and height of the upright rectangle that defines a person's box [m]."""


@dataclass(slots=True, eq=False)
class PanoramaScene:
    """An image, and the people found in it so far.

    Attributes:
        image: (H, W, 3) uint8 RGB.
        foreground: (H, W) foreground probability of each pixel.
        new: (H, W) difference from the background, 0..1.
        covered: (H, W) 1 where a found person is, 0 elsewhere.
        calibration: of the camera.
        rows: first row, and the one after the last, that the camera sees; others are covered.
        figures: integral images of these maps; renewed by `cover`.
    """

    image: NDArray[np.uint8]
    foreground: Map
    new: Map
    covered: Map
    calibration: PanoramaCalibration
    rows: tuple[int, int]
    figures: FigureMap

    @classmethod
    def of(
        cls,
        image: NDArray[np.uint8],
        foreground: Map,
        new: Map,
        calibration: PanoramaCalibration,
        rows: tuple[int, int] | None = None,
    ) -> "PanoramaScene":
        """Make one without people; the camera sees all rows unless some are given."""
        first, end = rows = (0, len(image)) if rows is None else rows
        covered = np.ones_like(foreground)
        covered[first:end] = 0.0
        figures = FigureMap.build(foreground, new, covered, calibration)
        return cls(image, foreground, new, covered, calibration, rows, figures)

    def cover(self, bearing_rad: float, distance_m: float) -> None:
        """Mark a found person's pixels as covered, for those behind."""
        rows, halves = _outline(distance_m, self.calibration)
        middle = (0.5 - bearing_rad / math.tau) * self.calibration.width - 0.5
        _cover(self.covered, self.foreground, middle, rows, halves)
        self.figures = FigureMap.build(self.foreground, self.new, self.covered, self.calibration)

    def hidden_share(self, bearing_rad: float, distance_m: float) -> float:
        """Return the share of a body's visible area that is covered by others."""
        left, top, width, height = self.box(bearing_rad, distance_m)
        first, end = self.rows
        top, bottom = max(top + 0.5, float(first)), min(top + height + 0.5, float(end))
        if bottom - top < 1.0:
            return 0.0
        left = left + 0.5 + 0.25 * width
        known = between(self.figures.sums, KNOWN, left, left + 0.5 * width, top, bottom)
        return 1.0 - known / (0.5 * width * (bottom - top))

    def box(self, bearing_rad: float, distance_m: float) -> Box:
        """Return the box [px] of an upright person, which may reach beyond the image and over the seam."""
        return person_box(bearing_rad, distance_m, self.calibration)


def person_box(bearing_rad: float, distance_m: float, calibration: PanoramaCalibration) -> Box:
    """Return the box [px] of an upright person; across the seam it reaches beyond the right border."""
    width_m, height_m = BODY_M
    top, bottom = calibration.row(distance_m, height_m), calibration.row(distance_m, 0.0)
    width = 2.0 * math.atan2(width_m / 2.0, distance_m) / math.tau * calibration.width
    middle = (0.5 - bearing_rad / math.tau) * calibration.width - 0.5
    left = (middle - width / 2.0 + 0.5) % calibration.width - 0.5
    return left, top, width, bottom - top


def _outline(distance_m: float, calibration: PanoramaCalibration) -> tuple[Floats, Floats]:
    """Return rows and half widths [px] of the outline, from its lower end up."""
    lowest, per_rad = calibration.height + 1.0, calibration.width / math.tau
    rows = [calibration.row(distance_m, height) for _, height in _OUTLINE_M]
    halves = [math.atan2(half, distance_m) * per_rad for half, _ in _OUTLINE_M]
    return np.array([lowest if math.isnan(row) else row for row in rows]), np.array(halves)


@njit(cache=True, nogil=True)
def _cover(covered: Map, foreground: Map, middle: float, rows: Floats, halves: Floats) -> None:
    height, width = covered.shape
    for part in range(len(rows) - 1):
        low, high = rows[part], rows[part + 1]
        for v in range(max(math.floor(high), 0), min(math.ceil(low), height - 1) + 1):
            share = min(max((low - v) / max(low - high, 1e-6), 0.0), 1.0)
            half = halves[part] + share * (halves[part + 1] - halves[part])
            for side in (-1, 1):
                has_begun = False
                for step in range(math.ceil(half) + 1):
                    u = (round(middle) + side * step) % width
                    is_person = foreground[v, u] > 0.3
                    if is_person:
                        covered[v, u] = 1.0
                        has_begun = True
                    elif has_begun and part >= _TRUNK:
                        break


# Candidate positions of untracked people.

NEAREST_M: Final = 1.1
FARTHEST_M: Final = 7.5
_RINGS: Final = np.geomspace(NEAREST_M, FARTHEST_M, 12)
_BEARINGS: Final = np.linspace(-math.pi, math.pi, 160, endpoint=False)
_LEAST: Final = 0.25
_APART_RAD: Final = math.radians(8.0)

# Limits of a standing body, of the floor before its feet, and of the area next to it [m]: to the left, to
# the right, from, up to.
_PARTS_M: Final = np.array(
    [(0.15, -0.15, 0.05, 1.2), (0.25, -0.25, -0.35, -0.1), (0.5, 0.3, 0.05, 1.2), (-0.3, -0.5, 0.05, 1.2)]
)
_LEAST_KNOWN: Final = 0.3
_LITTLE: Final = 0.1


def promising_places(figures: FigureMap, most: int) -> Floats:
    """Return up to a number of bearings [rad] and distances [m], (N, 2), of isolated bodies."""
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
    """Return bearings (N,), distances (N,), and (N, 4, 4) left, right, top, bottom [px] of the parts."""
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
    """Score positions: foreground in the body counts for, and in front of the feet or next to it against."""
    worth = np.empty(len(parts))
    shares = np.empty(4)
    for n in range(len(parts)):
        shares[:] = 0.0
        worth[n] = 0.0
        for part in range(4):
            if part == 1 and shares[0] < _LEAST:  # the other parts only count against
                break
            left, right, top, bottom = parts[n, part]
            if bottom - top < 0.5:  # outside the image
                continue
            area = (right - left) * (bottom - top)
            seen = between(sums, PEOPLE, left, right, top, bottom) / area
            if part == 0 and seen < _LEAST * _LITTLE:  # too few pixels for a person
                continue
            known = between(sums, KNOWN, left, right, top, bottom) / area
            if part > 0 or known > _LEAST_KNOWN:
                shares[part] = seen / max(known, _LITTLE)
        else:
            worth[n] = shares[0] - shares[1] - 0.25 * (shares[2] + shares[3])
    return worth
