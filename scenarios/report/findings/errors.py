"""How errors depend on the distance, and on how much of a person is visible."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from peopleboy.scenarios.report.findings.spans import Flags, Floats
from peopleboy.scenarios.report.findings.story import Story
from peopleboy.scenarios.report.findings.summary import Outcome

DISTANCES_M = (3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0)
VISIBLE = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
_FEWEST = 5  # frames in a bin, below which a figure says nothing


@dataclass(frozen=True, slots=True)
class Point:
    """One bin of a curve.

    Attributes:
        x: middle of the bin.
        mean: over runs of their means.
        sd: sample standard deviation over runs; NaN for fewer than two.
        frames: of people in the bin.
    """

    x: float
    mean: float
    sd: float
    frames: int


@dataclass(frozen=True, slots=True)
class Curve:
    """A figure over bins; bins in which nothing is known are left out."""

    label: str
    points: tuple[Point, ...]


def found_share(story: Story) -> Floats:
    """100 where a track lies on the person, else 0: (F,) [%]."""
    return np.where(np.isfinite(story.iou), 100.0, 0.0)


def offset(story: Story) -> Floats:
    """How far the middle of the box lies from the truth's [px]; NaN where there is none."""
    return story.offset_px


def distance(story: Story) -> Floats:
    """(F,) [m]."""
    return story.distance_m


def visible(story: Story) -> Floats:
    """(F,) share of the whole silhouette."""
    return story.visible


def curve(
    label: str,
    outcomes: Sequence[Outcome],
    over: Callable[[Story], Floats],
    figure: Callable[[Story], Floats],
    edges: Sequence[float],
) -> Curve:
    """Average a figure in bins, run by run, and then over the runs.

    Args:
        label: whose curve it is.
        outcomes: the runs.
        over: what the bins are of.
        figure: NaN where it is not defined.
        edges: of the bins; the last one is closed.
    """
    points = []
    for low, high in pairwise(edges):
        values = [_bin(outcome, over, figure, low, high, is_last=high == edges[-1]) for outcome in outcomes]
        known = np.array([part.mean() for part in values if len(part)])
        frames = sum(len(part) for part in values)
        if frames >= _FEWEST:
            sd = float(known.std(ddof=1)) if len(known) > 1 else np.nan
            points.append(Point((low + high) / 2.0, float(known.mean()), sd, frames))
    return Curve(label, tuple(points))


def _bin(
    outcome: Outcome,
    over: Callable[[Story], Floats],
    figure: Callable[[Story], Floats],
    low: float,
    high: float,
    *,
    is_last: bool,
) -> Floats:
    """All values (K,) of one run in a bin, of people who are to be found."""
    parts = [np.zeros(0)]
    for story in outcome.stories:
        x, y = over(story), figure(story)
        inside: Flags = (x >= low) & ((x <= high) if is_last else (x < high))
        parts.append(y[inside & np.isfinite(y) & story.is_counted & (story.visible > 0.0)])
    return np.concatenate(parts)
