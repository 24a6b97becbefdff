"""The tables of the 2003 paper: how far off distances, angles and positions in the panorama are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.distance_units import (
    DistanceUnit,
    NewPeopleUnit,
    WalkUnit,
)
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.reproductions.pictures.canvas import png_address
from peopleboy.studies.reproductions.pictures.panoramic_figures import (
    draw_correlations,
    draw_path,
    draw_ranges,
)
from peopleboy.studies.training.distance_learning.distance_examples import Examples
from peopleboy.studies.training.distance_learning.distance_trials import FILTERS, SplitTrial
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors

M, R = "m", "|r|"
ROOMS = ("room_long", "room_short", "room_narrow")
SPLIT_NAMES = {"random": "random split", "blocks": "by blocks"}
AVERAGE, GENERAL, OWN = "average", "general model", "each person's own model"
CUES = ("feature 1, width", "feature 2, distance to the bottom", "feature 3, pixels", "appearance model")

Film = Mapping[str, ImageErrors]
"""A film's errors by what was tried."""

Pick = Callable[[Film], ImageErrors]


def _called(name: str) -> Pick:
    return lambda film: film[name]


def _own(film: Film) -> ImageErrors:
    return ImageErrors.merged([film["person 1, model 1"], film["person 2, model 2"]])


_GENERAL: Mapping[str, Pick] = {
    AVERAGE: _called("general"),
    "best": lambda film: film["general"].best(),
    "worst": lambda film: film["general"].worst(),
}
_PERSONAL: Mapping[str, Pick] = {
    **{name: _called(name) for tested in "12" for name in (f"person {tested}, model {m}" for m in "12")},
    OWN: _own,
    GENERAL: _called("general"),
}


@dataclass(frozen=True, slots=True)
class Distances:
    """One table of errors of images, in every room, by both kinds of splits.

    Attributes:
        id: as `experiment.Experiment` says.
        picks: what a group's figures are of each film.
        has_new_people: whether people are tested, too, of whom nobody learned, in the first group.
    """

    id: str
    picks: Mapping[str, Pick]
    has_new_people: bool = False
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films first, then what is learned from them."""
        films: list[Unit] = [walk for room in ROOMS for walk in walks(plan, room)]
        return missing(films, done) or missing(self._lessons(plan, done), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Put the films of each room together."""
        found = {
            Line(group, f"{room}, {name}"): {
                M: ImageErrors.joined(pick(film) for film in _films(plan, done, room, split))
            }
            for group, pick in self.picks.items()
            for room in ROOMS
            for split, name in SPLIT_NAMES.items()
        }
        return found | (dict(self._new_people(plan, done)) if self.has_new_people else {})

    def picture(self, plan: Plan, done: Done) -> str | None:
        """Draw the error over the distance, where new people are tested."""
        if not self.has_new_people:
            return None
        return png_address(draw_ranges({room: examples_of(plan, done, room) for room in ROOMS}))

    def _lessons(self, plan: Plan, done: Done) -> Iterator[Unit]:
        for room in ROOMS:
            yield from (unit for split in SPLIT_NAMES for unit in _trials(plan, done, room, split))
            yield from _folds(plan, done, room) if self.has_new_people else ()

    def _new_people(self, plan: Plan, done: Done) -> Iterator[tuple[Line, dict[str, ImageErrors]]]:
        for room in ROOMS:
            films = [film for fold in _folds(plan, done, room) for film in done[fold.key]["films"]]
            errors = ImageErrors.joined(map(ImageErrors.of_plain, films))
            yield Line(next(iter(self.picks)), f"{room}, new people"), {M: errors}


@dataclass(frozen=True, slots=True)
class Correlations:
    """How features and the network's answer go with the distance: figure 5, one figure a film."""

    id: str = "panoramic-figure-5"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The same work as for the tables."""
        return Distances(self.id, _GENERAL).wants(plan, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the size of each correlation."""
        found = {}
        for room in ROOMS:
            table = np.abs([done[unit.key]["r"] for unit in _trials(plan, done, room, "random")])
            for cue, r in zip(CUES, table.T, strict=True):
                found[Line(cue, room)] = {R: r}
        return {line: found[line] for line in sorted(found, key=lambda line: CUES.index(line.group))}

    def picture(self, plan: Plan, done: Done) -> str:
        """Draw the four of the first film, as the paper does."""
        return png_address(draw_correlations(examples_of(plan, done, ROOMS[0])[0], CUES))


@dataclass(frozen=True, slots=True)
class FloorPath:
    """A piece of a path on the floor: figure 6."""

    id: str = "panoramic-figure-6"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """One film."""
        return missing(walks(plan, ROOMS[0])[:1], done)

    def samples(self, plan: Plan, done: Done) -> Samples:  # noqa: ARG002
        """Give nothing: the figure has no numbers."""
        return {}

    def picture(self, plan: Plan, done: Done) -> str:
        """Draw where a person was, and was thought to be."""
        first = walks(plan, ROOMS[0])[0]
        return png_address(draw_path(Examples.of_rows(done[first.key]["rows"])))


def walks(plan: Plan, room: str) -> list[WalkUnit]:
    """List the films of a room."""
    return [WalkUnit(room, seed) for seed in range(plan.walks)]


def examples_of(plan: Plan, done: Done, room: str) -> list[Examples]:
    """Give what was measured in each film of a room."""
    return [Examples.of_rows(done[walk.key]["rows"]) for walk in walks(plan, room)]


def _trials(plan: Plan, done: Done, room: str, split: str) -> list[DistanceUnit]:
    trial = SplitTrial(split=split, repeats=plan.splits)
    films = zip(walks(plan, room), examples_of(plan, done, room), strict=True)
    return [DistanceUnit(walk, trial, examples) for walk, examples in films]


def _films(plan: Plan, done: Done, room: str, split: str) -> Iterator[Film]:
    for unit in _trials(plan, done, room, split):
        yield {name: ImageErrors.of_plain(plain) for name, plain in done[unit.key]["errors"].items()}


def _folds(plan: Plan, done: Done, room: str) -> list[NewPeopleUnit]:
    """Learn from the even seeds and test on the odd ones, and the other way round."""
    films = tuple(examples_of(plan, done, room))
    trial = SplitTrial(split="random", repeats=1)
    return [NewPeopleUnit(room, tuple(range(first, plan.walks, 2)), trial, films) for first in range(2)]


def _positions(kind: str) -> Mapping[str, Pick]:
    return {way: _called(f"{kind}, {way}") for way in FILTERS}


DISTANCES = (
    Distances("panoramic-general", _GENERAL, has_new_people=True),
    Distances("panoramic-personal", _PERSONAL),
    Distances("panoramic-position", _positions("position")),
    Distances("panoramic-noise", _positions("noisy")),
)
"""The tables of sections 6.1 and 6.2."""
