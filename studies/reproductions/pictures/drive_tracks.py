"""People's ways before a depth camera, true and tracked: figures 4.25 to 4.33 of that thesis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from peopleboy.studies.reproductions.pictures.png import canvas, label

Floats = NDArray[np.float64]
Film = Mapping[str, Any]

_TRUE: Final = "#c62828"
_SIDEWAYS, _AHEAD = "#1f78b4", "#d95f02"
_IDS: Final = colormaps["tab10"]
_GAP: Final = 3  # frames that a way may miss before its line ends


def draw_ways(films: Mapping[str, Film], who: str) -> Figure:
    """Draw films' ways relative to the robot: who counts in red, tracks in a colour each."""
    columns = 3
    rows = math.ceil(len(films) / columns)
    figure = canvas(3.0 * rows)
    for number, (title, film) in enumerate(films.items(), 1):
        axes = figure.add_subplot(rows, columns, number)
        _draw_ways(axes, _counted(film), film[who]["told"])
        label(axes, title, "to the left [m]", "ahead [m]")
    return figure


def draw_world(film: Film, who: str) -> Figure:
    """Draw tracks in the world, and the way of the robot with where it looks."""
    figure = canvas(3.4)
    axes = figure.subplots()
    robot = np.array(film["robot"])
    axes.plot(robot[:, 0], robot[:, 1], "--", color=_TRUE, linewidth=1.2, label="robot")
    every = robot[:: max(len(robot) // 20, 1)]
    axes.quiver(
        every[:, 0],
        every[:, 1],
        np.cos(every[:, 2]),
        np.sin(every[:, 2]),
        color="#1f78b4",
        width=0.003,
        scale=40.0,
    )
    told = np.array(film[who]["told"]).reshape(-1, 4)
    pose = robot[told[:, 0].astype(int) - 1]
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x = pose[:, 0] + cosine * told[:, 2] - sine * told[:, 3]
    y = pose[:, 1] + sine * told[:, 2] + cosine * told[:, 3]
    _lines(axes, np.stack([told[:, 0], told[:, 1], x, y], axis=1), as_plan=False)
    axes.set_aspect("equal")
    label(axes, "", "x [m]", "y [m]")
    axes.legend(fontsize=7, frameon=False)
    return figure


def draw_people(films: Mapping[str, Film], who: str) -> Figure:
    """Draw mean and deviation of each person's errors, sideways and ahead."""
    names, means, spreads = [], [], []
    for title, film in films.items():
        hits = np.array(film[who]["hits"], dtype=np.float64).reshape(-1, 7)
        off = np.abs(hits[:, [6, 5]])
        for person in np.unique(hits[:, 1]):
            own = off[(hits[:, 1] == person) & np.isfinite(off).all(axis=1)]
            if len(own):
                names.append(f"{title.split()[-1]},{person:.0f}")
                means.append(own.mean(axis=0))
                spreads.append(own.std(axis=0))
    figure = canvas(3.2)
    axes = figure.subplots()
    at = np.arange(len(names))
    for column, (name, colour) in enumerate((("x, sideways", _SIDEWAYS), ("z, ahead", _AHEAD))):
        axes.bar(
            at + 0.4 * column - 0.2,
            [mean[column] for mean in means],
            0.38,
            yerr=[spread[column] for spread in spreads],
            color=colour,
            label=name,
            error_kw={"linewidth": 0.7},
        )
    axes.set_xticks(at, names, rotation=90)
    axes.set_ylim(bottom=0.0)
    label(axes, "", "set, person", "error [m]")
    axes.legend(fontsize=7, frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure


def draw_errors(film: Film, who: str) -> Figure:
    """Draw the distance of a film's first person over time, and the errors sideways and ahead."""
    hits = np.array(film[who]["hits"], dtype=np.float64).reshape(-1, 7)
    hits = hits[hits[:, 1] == hits[:, 1].min()]
    truth = np.array(film["truth"]).reshape(-1, 7)
    truth = truth[truth[:, 1] == hits[0, 1]]
    figure = canvas(4.0)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(truth[:, 0], truth[:, 4], color=_TRUE, linewidth=1.2)
    label(above, "", "", "distance [m]")
    for column, name, colour in ((6, "x, sideways", _SIDEWAYS), (5, "z, ahead", _AHEAD)):
        below.plot(hits[:, 0], hits[:, column], color=colour, linewidth=0.9, label=name)
    below.axhline(0.0, color="#999999", linewidth=0.6)
    label(below, "", "image", "error [m]")
    below.legend(fontsize=7, frameon=False)
    return figure


def draw_crossing(film: Film, names: Mapping[str, str]) -> Figure:
    """Draw the true ways of a film beside those of several trackers, which `names` gives titles."""
    figure = canvas(3.2)
    first, *others = figure.subplots(1, 1 + len(names), sharex=True, sharey=True)
    _lines(first, _counted(film))
    label(first, "true", "to the left [m]", "ahead [m]")
    for axes, (who, title) in zip(others, names.items(), strict=True):
        _lines(axes, np.array(film[who]["told"]).reshape(-1, 4))
        label(axes, title, "to the left [m]")
    return figure


def draw_legs(film: Film) -> Figure:
    """Draw a person's way relative to the robot, and the distance over time: true, by depth, by legs."""
    truth = _counted(film)
    figure = canvas(3.6)
    left, right = figure.subplots(1, 2)
    for name, rows, colour in (
        ("true", truth, "#1f78b4"),
        ("depth and colour", np.array(film["depth"]).reshape(-1, 4), "#2e7d32"),
        ("legs", np.array(film["legs"]).reshape(-1, 4), _TRUE),
    ):
        size = 1.2 if name != "true" else 2.4
        left.plot(rows[:, 3], rows[:, 2], ".", markersize=size, color=colour, label=name)
        right.plot(rows[:, 0], np.hypot(rows[:, 2], rows[:, 3]), ".", markersize=size, color=colour)
    left.invert_xaxis()
    label(left, "", "to the left [m]", "ahead [m]")
    label(right, "", "image", "from the robot [m]")
    left.legend(fontsize=7, frameon=False, markerscale=4)
    return figure


def _draw_ways(axes: Axes, truth: Floats, told: Sequence[Sequence[float]]) -> None:
    _lines(axes, truth, colour=_TRUE, width=2.0)
    _lines(axes, np.array(told).reshape(-1, 4))


def _counted(film: Film) -> Floats:
    """Give frame, person and place (N, 4) of everybody who counts."""
    truth = np.array(film["truth"], dtype=np.float64).reshape(-1, 7)
    return np.asarray(truth[truth[:, 6] > 0.0][:, :4])


def _lines(
    axes: Axes, rows: Floats, colour: str | None = None, width: float = 1.0, *, as_plan: bool = True
) -> None:
    """Draw the way of each id of rows (N, 4), frame, id, x, y; on a plan x is up and y to the left."""
    for number, identity in enumerate(np.unique(rows[:, 1])):
        own = rows[rows[:, 1] == identity]
        breaks = np.flatnonzero(np.diff(own[:, 0]) > _GAP) + 1
        for part in np.split(own, breaks):
            x, y = (part[:, 3], part[:, 2]) if as_plan else (part[:, 2], part[:, 3])
            axes.plot(x, y, color=colour or _IDS(number % 10), linewidth=width)
    if as_plan and not axes.xaxis_inverted():
        axes.invert_xaxis()
