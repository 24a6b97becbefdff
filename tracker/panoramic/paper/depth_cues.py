"""Where a silhouette lies in the panorama, and the three features that tell how far away the person is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.panoramic.paper.background import Mask
from peopleboy.tracker.track import Box


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
    """Give first column and number of columns of the shortest arc that holds every filled one of (W,)."""
    filled = np.flatnonzero(columns)
    steps = np.diff(filled, append=filled[0] + len(columns))
    widest = int(np.argmax(steps))
    return int(filled[(widest + 1) % len(filled)]), len(columns) - int(steps[widest]) + 1
