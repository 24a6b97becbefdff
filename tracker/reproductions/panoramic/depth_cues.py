"""Silhouettes in the panorama, and the three features that indicate a person's distance."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.track import Box

# Background subtraction with an image of the empty scene.

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

EMPTY_IMAGES = 5
"""Number of empty images for the background (section 4.2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Subtraction:
    """Settings of the background subtraction.

    The paper only says that its threshold is "learned during background acquisition". Here it is learned from
    the difference of each empty image from the mean of the others, as a future image is in no mean either.

    Attributes:
        is_colour: whether red, green and blue are compared separately, or their grey.
        deviations: threshold in standard deviations of those differences; None for their maximum.
        median_px: width of the median filter over the silhouette; 1 for none.
    """

    is_colour: bool
    deviations: float | None
    median_px: int


LITERAL = Subtraction(is_colour=False, deviations=4.0, median_px=1)
"""The paper's text, without additions. One noisy pixel in a lower row then counts as a foot."""

CLEAN = Subtraction(is_colour=True, deviations=None, median_px=3)
"""Detects grey shoes on a grey floor, and suppresses single pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class Background:
    """Background of the empty scene.

    Attributes:
        mean: (H, W, C) mean of the empty images; C is 1 or 3, depending on `subtraction`.
        threshold: (C,) least difference of foreground pixels, in grey levels.
        subtraction: settings.
    """

    mean: Floats
    threshold: Floats
    subtraction: Subtraction

    def silhouette(self, image: NDArray[np.uint8]) -> Mask:
        """Return which pixels (H, W) of an RGB image (H, W, 3) are foreground.

        Raises:
            BadInput: an image of another size.
        """
        if image.shape[:2] != self.mean.shape[:2]:
            (height, width), (rows, columns) = image.shape[:2], self.mean.shape[:2]
            raise BadInput(f"panorama is {width}x{height}, but its background {columns}x{rows}")
        differs = _differs(_planes(image, self.subtraction), self.mean, self.threshold)
        return _smooth(differs, self.subtraction.median_px)


def learn_background(empty: Sequence[NDArray[np.uint8]], subtraction: Subtraction = CLEAN) -> Background:
    """Learn the background from two or more RGB images (H, W, 3) of the empty scene.

    Source: OMNIVIS 2003, section 4.2.
    """
    planes = np.stack([_planes(image, subtraction) for image in empty]).astype(np.float64)
    mean, count = planes.mean(axis=0), len(planes)
    differences = np.abs(planes - mean) * (count / (count - 1))  # from the mean of all others
    if subtraction.deviations is None:
        threshold = differences.max(axis=(0, 1, 2))
    else:
        threshold = subtraction.deviations * np.sqrt((differences**2).mean(axis=(0, 1, 2)))
    return Background(mean=mean, threshold=threshold, subtraction=subtraction)


def _planes(image: NDArray[np.uint8], subtraction: Subtraction) -> NDArray[np.uint8]:
    planes = image if subtraction.is_colour else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)[..., None]
    return np.ascontiguousarray(planes)


@njit(cache=True)
def _differs(planes: NDArray[np.uint8], mean: Floats, threshold: Floats) -> NDArray[np.uint8]:
    """Return a mask (H, W): 1 where a plane of an image (H, W, C) differs by more than its threshold."""
    height, width, count = planes.shape
    differs = np.zeros((height, width), np.uint8)
    for v in range(height):
        for u in range(width):
            for c in range(count):
                differs[v, u] |= abs(planes[v, u, c] - mean[v, u, c]) > threshold[c]
    return differs


def _smooth(mask: NDArray[np.uint8], median_px: int) -> Mask:
    """Apply a median filter that wraps around the seam."""
    if median_px > 1:
        half = median_px // 2
        ring = np.hstack([mask[:, -half:], mask, mask[:, :half]])
        return cv2.medianBlur(ring, median_px)[:, half:-half].astype(np.bool_)
    return mask.astype(np.bool_)


class DepthCues(NamedTuple):
    """The inputs of the network (section 4.3).

    Attributes:
        width_px: between the limits of the column histogram; it includes the gap between two legs.
        gap_px: rows between the person's lowest row and the lower edge of the image; 0 if the feet are
            outside the image.
        area_px: number of foreground pixels.
    """

    width_px: float
    gap_px: float
    area_px: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredFigure:
    """Measurements of one person's silhouette.

    Attributes:
        columns: (W,) pixels in each column.
        rows: (H,) pixels in each row.
        first_column: start of the shortest arc that holds all pixels; it may cross the seam.
        mean_column: of the column histogram along that arc, in -0.5..W - 0.5.
        cues: width, gap and area.
    """

    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    first_column: int
    mean_column: float
    cues: DepthCues

    @property
    def bearing_rad(self) -> float:
        """Bearing of the person from the robot's heading, left positive [rad]."""
        return bearing(self.mean_column, len(self.columns))

    @property
    def box(self) -> Box:
        """The silhouette's box [px]; across the seam it reaches beyond the right edge."""
        filled = np.flatnonzero(self.rows)
        height = float(filled[-1] - filled[0] + 1)
        return self.first_column - 0.5, float(filled[0]) - 0.5, self.cues.width_px, height


def bearing(column: float, width_px: int) -> float:
    """Return the bearing of a column, left positive, -pi..pi [rad]; column 0 is behind the robot."""
    return math.pi - math.tau * (column + 0.5) / width_px


def measure(silhouette: Mask, least_px: int = 1) -> MeasuredFigure | None:
    """Measure the silhouette (H, W) of one person; None if it has too few pixels.

    Source: OMNIVIS 2003, sections 4.2 and 4.3. The paper's mean of columns is counted from the end of the
    widest empty gap, so that the person may be on the seam.
    """
    columns, rows = silhouette.sum(axis=0), silhouette.sum(axis=1)
    area, width = int(columns.sum()), len(columns)
    if area < max(least_px, 1):
        return None
    first, extent = covering_arc(columns)
    offset = float(columns @ ((np.arange(width) - first) % width)) / area
    gap = len(rows) - 1 - int(np.flatnonzero(rows)[-1])
    return MeasuredFigure(
        columns=columns,
        rows=rows,
        first_column=first,
        mean_column=_wrapped(first + offset, width),
        cues=DepthCues(float(extent), float(gap), float(area)),
    )


def _wrapped(column: float, width: int) -> float:
    """Wrap a column into -0.5..W - 0.5."""
    return column - width if column >= width - 0.5 else column


def covering_arc(columns: NDArray[np.int64]) -> tuple[int, int]:
    """Return start and length of the shortest arc that holds every filled column of (W,)."""
    filled = np.flatnonzero(columns)
    steps = np.diff(filled, append=filled[0] + len(columns))
    widest = int(np.argmax(steps))
    return int(filled[(widest + 1) % len(filled)]), len(columns) - int(steps[widest]) + 1
