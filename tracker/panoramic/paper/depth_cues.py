"""Where a silhouette lies in the panorama, and the three features that tell how far away the person is."""

from __future__ import annotations

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

# The empty scene as the panoramic camera sees it, and what differs from it.

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

EMPTY_IMAGES = 5
"""How many images of the empty scene make the background (section 4.2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Subtraction:
    """How differences from the background become a silhouette.

    The paper says only that its threshold is "learned during background acquisition". Here it is learned from
    what each empty image differs from the mean of the others, since an image to come is in no mean either.

    Attributes:
        is_colour: whether red, green and blue are compared one by one, or their grey.
        deviations: the threshold, in standard deviations of those differences; None for the greatest of them.
        median_px: width of the median filter over the silhouette; 1 for none.
    """

    is_colour: bool
    deviations: float | None
    median_px: int


LITERAL = Subtraction(is_colour=False, deviations=4.0, median_px=1)
"""What the paper's words say and no more. One pixel of noise in a lower row is then a foot."""

CLEAN = Subtraction(is_colour=True, deviations=None, median_px=3)
"""Sees grey shoes on a grey floor, and lets no lone pixel through."""


@dataclass(frozen=True, slots=True, eq=False)
class Background:
    """The empty scene.

    Attributes:
        mean: (H, W, C) mean of the empty images, C being 1 or 3 as `subtraction` says.
        threshold: (C,) what a pixel must differ by, in grey levels.
        subtraction: how it was learned and is taken away.
    """

    mean: Floats
    threshold: Floats
    subtraction: Subtraction

    def silhouette(self, image: NDArray[np.uint8]) -> Mask:
        """Return which pixels (H, W) of an RGB image (H, W, 3) differ from the background.

        Raises:
            BadInput: an image of another size.
        """
        if image.shape[:2] != self.mean.shape[:2]:
            (height, width), (rows, columns) = image.shape[:2], self.mean.shape[:2]
            raise BadInput(f"panorama is {width}x{height}, but its background {columns}x{rows}")
        differs = _differs(_planes(image, self.subtraction), self.mean, self.threshold)
        return _smooth(differs, self.subtraction.median_px)


def learn_background(empty: Sequence[NDArray[np.uint8]], subtraction: Subtraction = CLEAN) -> Background:
    """Learn the empty scene from two or more RGB images (H, W, 3) without anybody.

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
    """Give 1 where (H, W) a plane of an image (H, W, C) differs from the mean by more than its threshold."""
    height, width, count = planes.shape
    differs = np.zeros((height, width), np.uint8)
    for v in range(height):
        for u in range(width):
            for c in range(count):
                differs[v, u] |= abs(planes[v, u, c] - mean[v, u, c]) > threshold[c]
    return differs


def _smooth(mask: NDArray[np.uint8], median_px: int) -> Mask:
    """Take the median over squares that go on across the seam."""
    if median_px > 1:
        half = median_px // 2
        ring = np.hstack([mask[:, -half:], mask, mask[:, :half]])
        return cv2.medianBlur(ring, median_px)[:, half:-half].astype(np.bool_)
    return mask.astype(np.bool_)


class DepthCues(NamedTuple):
    """The inputs of the network (section 4.3).

    Attributes:
        width_px: between the limits of the histogram of columns; the gap between two legs counts.
        gap_px: rows between the person's lowest one and the lower edge of the image; 0 once the feet are out
            of the picture.
        area_px: pixels that differ from the background.
    """

    width_px: float
    gap_px: float
    area_px: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredFigure:
    """One person's silhouette, measured.

    Attributes:
        columns: (W,) pixels in each column.
        rows: (H,) pixels in each row.
        first_column: where the shortest arc that holds all of them begins; it may go on across the seam.
        mean_column: of the histogram of columns, along that arc, in -0.5..W - 0.5.
        cues: how wide, how low, how many.
    """

    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    first_column: int
    mean_column: float
    cues: DepthCues

    @property
    def bearing_rad(self) -> float:
        """Where the person is, from the robot's nose, left positive [rad]."""
        return bearing(self.mean_column, len(self.columns))

    @property
    def box(self) -> Box:
        """The silhouette's box [px]; one that crosses the seam reaches beyond the right edge."""
        filled = np.flatnonzero(self.rows)
        height = float(filled[-1] - filled[0] + 1)
        return self.first_column - 0.5, float(filled[0]) - 0.5, self.cues.width_px, height


def bearing(column: float, width_px: int) -> float:
    """Tell where a column looks, from the robot's nose, left positive, -pi..pi [rad]; column 0 is behind."""
    return math.pi - math.tau * (column + 0.5) / width_px


def measure(silhouette: Mask, least_px: int = 1) -> MeasuredFigure | None:
    """Measure the silhouette (H, W) of one person; None if it has fewer pixels than that.

    Source: OMNIVIS 2003, sections 4.2 and 4.3. The mean of the columns is the paper's, but begins to count
    where the widest gap between filled columns ends, so that the seam may go through the person.
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
    """Bring a column into -0.5..W - 0.5, which is where pixels are."""
    return column - width if column >= width - 0.5 else column


def covering_arc(columns: NDArray[np.int64]) -> tuple[int, int]:
    """Return first column and number of columns of the shortest arc that holds every filled one of (W,)."""
    filled = np.flatnonzero(columns)
    steps = np.diff(filled, append=filled[0] + len(columns))
    widest = int(np.argmax(steps))
    return int(filled[(widest + 1) % len(filled)]), len(columns) - int(steps[widest]) + 1
