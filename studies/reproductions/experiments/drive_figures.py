"""Figures of the thesis on situation awareness: people's ways, true and tracked, and errors over time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from peopleboy.studies.reproductions.evaluations.drive_scores import RADIUS_M
from peopleboy.studies.reproductions.evaluations.drive_tracking import (
    CHOICES,
    DEFAULT,
    NO_DEPTH,
    SETS,
    set_name,
)
from peopleboy.studies.reproductions.experiments.drives import MAIN, columns, drive
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.drive_units import LegsUnit
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.reproductions.pictures.canvas import png_address
from peopleboy.studies.reproductions.pictures.situation_figures import (
    draw_crossing,
    draw_errors,
    draw_legs,
    draw_people,
    draw_ways,
    draw_world,
)

Films = dict[str, Any]

_CROSSING: Final = 7
_FOLLOWED: Final = 2
_RANGES_M: Final = {"up to 3 m": (0.0, 3.0), "3 to 5 m": (3.0, 5.0), "5 to 10 m": (5.0, 10.0)}


@dataclass(frozen=True, slots=True)
class DriveFigure:
    """A figure of some sets, each played with seed 0.

    Attributes:
        id: as `experiment.Experiment` says.
        sets: their numbers; those that a plan leaves out are left out here, too.
        draw: draws films by the name of their set.
        names: of the trackers who saw them.
    """

    id: str
    sets: tuple[int, ...]
    draw: Callable[[Films], Figure]
    names: tuple[str, ...] = MAIN
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The films."""
        return missing(self._films(plan).values(), done)

    def samples(self, plan: Plan, done: Done) -> Samples:  # noqa: ARG002
        """Give nothing: the figure has no numbers."""
        return {}

    def picture(self, plan: Plan, done: Done) -> str | None:
        """Draw it; None where a plan leaves out all of its sets."""
        films = {name: done[unit.key] for name, unit in self._films(plan).items()}
        return png_address(self.draw(films)) if films else None

    def _films(self, plan: Plan) -> dict[str, Unit]:
        numbers = [number for number in self.sets if number in plan.sets]
        return {set_name(n): drive(plan, SETS[n - 1], 0, self.names) for n in numbers}


@dataclass(frozen=True, slots=True)
class Legs:
    """A tracker of legs beside the one of depth and colour: figure 4.33."""

    id: str = "situation-figure-4.33"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """One film."""
        return missing([_legs(plan)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give by range the share of images in which the person is found."""
        film = done[_legs(plan).key]
        return {
            Line(group, who): columns([{"rate": _found(film, film[key], *limits)}])
            for group, limits in _RANGES_M.items()
            for who, key in ((DEFAULT, "depth"), ("legs", "legs"))
        }

    def picture(self, plan: Plan, done: Done) -> str:
        """Draw all three ways."""
        return png_address(draw_legs(done[_legs(plan).key]))


def _legs(plan: Plan) -> LegsUnit:
    return LegsUnit(SETS[_FOLLOWED - 1], plan.drive_s)


def _found(film: Films, told: list[list[float]], nearest_m: float, farthest_m: float) -> float:
    """Tell in which share of the images somebody in plain view and range is said to be within 1 m."""
    places: dict[int, list[list[float]]] = {}
    for frame, _, *place in told:
        places.setdefault(int(frame), []).append(place)
    wanted = [row for row in film["truth"] if row[6] and nearest_m <= row[4] < farthest_m]
    hits = [
        any(np.hypot(x - row[2], y - row[3]) <= RADIUS_M for x, y in places.get(int(row[0]), []))
        for row in wanted
    ]
    return float(np.mean(hits)) if hits else float("nan")


def _only(films: Films) -> Any:
    (film,) = films.values()
    return film


FIGURES = (
    DriveFigure("situation-figure-4.25", (1, 2, 3, 6, 11, 12), lambda films: draw_ways(films, DEFAULT)),
    DriveFigure("situation-figure-4.26", (6,), lambda films: draw_world(_only(films), DEFAULT)),
    DriveFigure("situation-figure-4.28", tuple(range(1, 13)), lambda films: draw_people(films, DEFAULT)),
    DriveFigure("situation-figure-4.29", (_FOLLOWED,), lambda films: draw_errors(_only(films), DEFAULT)),
    DriveFigure(
        "situation-figure-4.30",
        (_CROSSING,),
        lambda films: draw_crossing(
            _only(films), {NO_DEPTH: "filters without depth", DEFAULT: "filters with depth"}
        ),
        tuple(CHOICES),
    ),
    Legs(),
)
"""Figures of section 4.7 of that thesis."""
