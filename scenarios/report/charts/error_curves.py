"""Draw errors over the distance, and over the visible share of a person."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from textwrap import fill
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from peopleboy.scenarios.report.columns import Column
from peopleboy.scenarios.report.findings.histories import Floats
from peopleboy.scenarios.report.findings.run_findings import RunFindings
from peopleboy.scenarios.report.page_parts import LINE, SERIES, inline, new_figure, set_tooltip, svg_style
from peopleboy.tracker.evaluation.box_matching import counts

VISIBLE = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
_FEWEST = 5  # boxes in a bin; smaller bins are omitted
_DASHES = ("-", (0, (4, 2)), (0, (1.4, 2)), (0, (5, 2, 1.4, 2)))
_WIDTH_PT, _HEIGHT_PT = 280.0, 150.0

Samples = dict[str, Floats]
"""Arrays (K,), one value per frame of a counted person who is at least partly visible.

distance [m]; visible: share of the silhouette; found: 100 if a track is on the person, else 0 [%];
offset: distance of the box centre from that of the ground truth [px], NaN without a box.
"""


class CurvePoint(NamedTuple):
    """One bin of a curve."""

    x: float  # middle of the bin
    mean: float  # mean over runs of the means of runs
    sd: float  # sample standard deviation over runs; 0 for fewer than two
    boxes: int  # number of boxes in the bin


def distance_edges(runs: Iterable[RunFindings]) -> tuple[float, ...]:
    """Return the edges [m] of bins, one metre wide, over all distances at which people are counted."""
    nearest_m, farthest_m = zip(*(found.counted_m for found in runs), strict=True)
    first, last = min(nearest_m), max(farthest_m)
    return (first, *(float(edge) for edge in range(math.floor(first) + 1, math.ceil(last))), last)


def samples(found: RunFindings) -> Samples:
    """Collect the samples of a run, once per image."""
    parts: list[list[Floats]] = [[np.zeros(0)] * 4]
    for person in found.people:
        at = counts(person.is_counted, person.visible) & (np.arange(found.run.frames) % found.every == 0)
        hits = np.where(np.isfinite(person.iou), 100.0, 0.0)
        parts.append([c[at] for c in (person.distance_m, person.visible, hits, person.offset_px)])
    columns = [np.concatenate(part) for part in zip(*parts, strict=True)]
    return dict(zip(("distance", "visible", "found", "offset"), columns, strict=True))


def curve(runs: Sequence[Samples], over: str, figure: str, edges: Sequence[float]) -> list[CurvePoint]:
    """Average a value in bins, the last one closed, first within each run and then over runs.

    Bins with fewer than five boxes are omitted.
    """
    points = []
    for low, high in pairwise(edges):
        end = np.inf if high == edges[-1] else high
        parts = [
            of[figure][(of[over] >= low) & (of[over] <= high) & (of[over] < end) & np.isfinite(of[figure])]
            for of in runs
        ]
        means = np.array([part.mean() for part in parts if len(part)])
        boxes = sum(map(len, parts))
        if boxes >= _FEWEST:
            sd = float(means.std(ddof=1)) if len(means) > 1 else 0.0
            points.append(CurvePoint((low + high) / 2.0, float(means.mean()), sd, boxes))
    return points


def draw_error_curves(columns: Sequence[Column]) -> list[tuple[str, Markup]]:
    """Draw detection rate and position error of boxes for all columns; return charts with titles."""
    runs = {column.label: [samples(found) for found in column.runs] for column in columns}
    distances_m = distance_edges(found for column in columns for found in column.runs)
    charts = []
    for figure, title, top, unit in (
        ("found", "People found", 100.0, "%"),
        ("offset", "Position error of boxes", None, "px"),
    ):
        if figure == "offset" and not any(
            np.isfinite(one[figure]).any() for of in runs.values() for one in of
        ):
            continue  # tracks on the floor have no boxes
        for over, edges, ticks, label, words in (
            ("distance", distances_m, distances_m[1::2], "distance from the camera [m]", "over distance"),
            ("visible", VISIBLE, VISIBLE, "visible fraction of the person", "over visible fraction"),
        ):
            curves = {name: curve(of, over, figure, edges) for name, of in runs.items()}
            name = f"{title} {words} [{unit}]"
            charts.append((name, _draw(name, curves, (label, edges, ticks), top, unit)))
    return charts


@svg_style
def _draw(
    title: str,
    curves: dict[str, list[CurvePoint]],
    across: tuple[str, Sequence[float], Sequence[float]],
    top: float | None,
    unit: str,
) -> Markup:
    label, edges, ticks = across
    figure = new_figure(_WIDTH_PT, _HEIGHT_PT)
    figure.set_layout_engine("constrained")
    axes = figure.add_subplot()
    texts = []
    for (name, points), colour, dash in zip(curves.items(), SERIES, _DASHES, strict=False):
        x, mean, sd = ([getattr(p, key) for p in points] for key in ("x", "mean", "sd"))
        axes.errorbar(x, mean, sd, color=colour, ls=dash, lw=1.6, elinewidth=1.0, label=fill(name, 48))
        words = [f"at {p.x:.2g}: {_value(p, unit)} ({p.boxes} boxes)" for p in points]
        for p, said in zip(points, words, strict=True):
            (dot,) = axes.plot(p.x, p.mean, "o", ms=5.5, mfc=colour, mec="#ffffff", zorder=3, clip_on=False)
            set_tooltip(dot, f"{name} {said}")
        texts.append(f"{name}: {'; '.join(words)}")
    axes.set(xlim=(edges[0], edges[-1]), xticks=ticks, xlabel=label)
    axes.set_ylim(0.0, top)
    axes.locator_params(axis="y", nbins=5)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.grid(axis="y", color=LINE)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0.0, pad=5.0)
    if len(curves) > 1:
        figure.legend(loc="outside upper left", frameon=False, ncols=2)
    return inline(figure, title, f"{title}. {'. '.join(texts)}")


def _value(point: CurvePoint, unit: str) -> str:
    return f"{point.mean:.1f}{f' ± {point.sd:.1f}' if point.sd else ''} {unit}"
