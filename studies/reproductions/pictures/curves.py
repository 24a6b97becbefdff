"""Curves of what was measured in films: figures 5 and 6 of the 2003 paper, and errors over the distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.studies.reproductions.pictures.png import canvas, label
from peopleboy.studies.training.distance_learning.distance_examples import Examples
from peopleboy.studies.training.distance_learning.distance_trials import SplitTrial, told_in_turn
from peopleboy.studies.training.distance_learning.walks import filtered
from peopleboy.tracker.panoramic.paper.position_filter import PRINTED, PositionFilter

Floats = NDArray[np.float64]

_TRUE, _MODEL, _FILTER = "#1a1a1a", "#d95f02", "#1f78b4"
_PEOPLE: Final = ("#1f78b4", "#d95f02")
_ROOMS: Final = ("#1f78b4", "#d95f02", "#66a61e")
_FRAGMENT: Final = slice(60, 110)  # of a film's images: some 17 s
_RANGE_M, _LEAST = 0.5, 30  # width of a class of distances, and images that it must have


def draw_correlations(run: Examples, names: Sequence[str]) -> Figure:
    """Draw each cue of a film, and what the network tells, over the true distance."""
    told = told_in_turn(run, SplitTrial(split="random"))
    figure = canvas(5.6)
    for axes, name, values in zip(figure.subplots(2, 2).flat, names, (*run.cues.T, told), strict=True):
        for person, colour in zip(np.unique(run.person).tolist(), _PEOPLE, strict=False):
            is_here = run.person == person
            axes.plot(
                run.distance_m[is_here],
                values[is_here],
                ".",
                markersize=2.5,
                color=colour,
                label=f"person {person}",
            )
        r = np.corrcoef(values, run.distance_m)[0, 1]
        label(axes, f"{name}: r = {r:.3f}", "true distance [m]", "m" if values is told else "px")
    figure.axes[0].legend(fontsize=7, frameon=False, markerscale=3)
    return figure


def draw_path(run: Examples) -> Figure:
    """Draw a piece of a path on the floor: true, by the model alone, and with the filter."""
    measured = run.seen_at(told_in_turn(run, SplitTrial(split="blocks")))
    smooth = filtered(run, measured, PositionFilter(PRINTED, uses_velocity=True))
    figure = canvas(4.6)
    axes = figure.subplots()
    for name, place, colour, style, width in (
        ("true", run.true_m, _TRUE, "-", 2.0),
        ("appearance model", measured, _MODEL, "x-", 0.6),
        ("with Kalman filter", smooth, _FILTER, "o-", 1.2),
    ):
        x, y = place[_FRAGMENT].T
        axes.plot(-y, x, style, color=colour, linewidth=width, markersize=3, label=name)
    axes.plot(0.0, 0.0, "s", color="#d64541", markersize=9)
    axes.annotate("robot", (0.0, 0.0), (8, 6), textcoords="offset points", fontsize=8)
    axes.set_aspect("equal")
    axes.legend(fontsize=8, frameon=False)
    label(axes, "", "to the robot's right [m]", "ahead [m]")
    return figure


def draw_ranges(films: Mapping[str, Sequence[Examples]]) -> Figure:
    """Draw the mean error of the distance over the distance, by room; nobody is tested on whom it learned."""
    figure = canvas(3.4)
    axes = figure.subplots()
    for (room, runs), colour in zip(films.items(), _ROOMS, strict=False):
        distance = np.concatenate([run.distance_m for run in runs])
        errors = np.concatenate(
            [np.abs(told_in_turn(run, SplitTrial(split="blocks")) - run.distance_m) for run in runs]
        )
        middles, means, spreads = error_by_range(distance, errors)
        axes.plot(middles, means, "o-", color=colour, markersize=4, label=room)
        axes.fill_between(
            middles, np.maximum(means - spreads, 0.0), means + spreads, color=colour, alpha=0.12, linewidth=0
        )
    axes.set_ylim(bottom=0.0)
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    axes.legend(fontsize=8, frameon=False, loc="upper left")
    label(axes, "", "true distance [m]", "error of the distance [m]")
    return figure


def error_by_range(distance_m: Floats, errors_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Give the middles [m] of classes of distances, and mean and deviation of the errors there, each (K,)."""
    number = np.floor(distance_m / _RANGE_M).astype(np.int64)
    known = [k for k in np.unique(number).tolist() if np.count_nonzero(number == k) >= _LEAST]
    return (
        (np.array(known, np.float64) + 0.5) * _RANGE_M,
        np.array([errors_m[number == k].mean() for k in known]),
        np.array([errors_m[number == k].std() for k in known]),
    )
