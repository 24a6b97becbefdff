"""What an experiment is: work to be done, and the samples that come of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.running.engine.store import Result, Store
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors

Chart = Literal["bars", "lines", "none"]


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a table.

    Attributes:
        group: what is varied, as in the source: a data set, a number of samples, a step.
        who: whose figures these are: a tracker, or a way to count.
    """

    group: str
    who: str


@dataclass(frozen=True, slots=True, eq=False)
class FilmFigure:
    """A figure of a single repeat, and what it would be without each of its films.

    Attributes:
        whole: of all films.
        without: (F,) of all but one.
        films: names of the data sets that they are; figures of the same films have the same.
    """

    whole: float
    without: NDArray[np.float64]
    films: tuple[str, ...]

    @property
    def by_film(self) -> NDArray[np.float64]:
        """Give the jackknife's pseudo-values (F,), which stand for figures of each film by itself.

        Source: Miller, "The jackknife - a review", Biometrika 61, 1974.
        """
        count = len(self.without)
        return count * self.whole - (count - 1) * self.without


Figures = NDArray[np.float64] | FilmFigure | ImageErrors
"""Of one line and column: (R,) one figure per repeat, that of a single one by films, or errors of images."""

Samples = Mapping[Line, Mapping[str, Figures]]
"""Of each line, by the column's name."""

Done = Mapping[str, Result]


class Experiment(Protocol):
    """A table or figure of a source."""

    @property
    def id(self) -> str:
        """A name such as "figure-4.8" or "paper-table-1", as in the file of the source's figures."""
        ...

    @property
    def chart(self) -> Chart:
        """How it is drawn."""
        ...

    @property
    def plotted(self) -> tuple[str, ...]:
        """Columns that are drawn."""
        ...

    def wants(self, plan: Plan, done: Done) -> Iterable[Unit]:
        """List the work that is missing and can be begun; nothing once all is done."""
        ...

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the figures, once all is done."""
        ...


@dataclass(frozen=True, slots=True)
class Effort:
    """What an experiment took, with the films and runs that it shares with others.

    Attributes:
        units: pieces of work.
        seconds: [s] of processor time for them.
    """

    units: int
    seconds: float


class Touched(Mapping[str, Result]):
    """Results, and which of them somebody has asked for."""

    def __init__(self, done: Done) -> None:
        self._done = done
        self.keys_asked: set[str] = set()

    def __getitem__(self, key: str) -> Result:
        self.keys_asked.add(key)
        return self._done[key]

    def __contains__(self, key: object) -> bool:
        self.keys_asked.add(str(key))
        return key in self._done

    def __iter__(self) -> Iterator[str]:
        return iter(self._done)

    def __len__(self) -> int:
        return len(self._done)


@runtime_checkable
class Depicted(Protocol):
    """An experiment that has a picture of its own in place of a chart."""

    def picture(self, plan: Plan, done: Done) -> str | None:
        """Give the address of its picture, once all is done; None for none."""
        ...


@runtime_checkable
class Grouped(Protocol):
    """An experiment of which a quick run leaves lines out."""

    @property
    def groups(self) -> Sequence[str]:
        """What is varied in a full run, in the order of its lines."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What an experiment has come to.

    Attributes:
        experiment: which one.
        samples: its figures.
        picture: address of a picture of its own; None for none.
        left_out: groups of a full run that this one has not.
        effort: what it took; None if that is not known.
    """

    experiment: Experiment
    samples: Samples
    picture: str | None = None
    left_out: tuple[str, ...] = ()
    effort: Effort | None = None

    @property
    def repeats(self) -> int | None:
        """How many values each figure is of: repeats, splits or turns; None where there are none."""
        sizes = [
            1 if isinstance(values, FilmFigure) else values.size
            for values in self._figures()
            if not isinstance(values, ImageErrors)
        ]
        return max(sizes, default=None)

    @property
    def films(self) -> int | None:
        """Over how many films the intervals are; None where they are over repeats."""
        sizes = [len(values.without) for values in self._figures() if isinstance(values, FilmFigure)]
        return max(sizes, default=None)

    def _figures(self) -> Iterator[Figures]:
        return (values for figures in self.samples.values() for values in figures.values())

    @classmethod
    def of(cls, experiment: Experiment, plan: Plan, store: Store) -> Outcome | None:
        """Ask an experiment for all that it has; None if some of its work is missing."""
        done = Touched(store)
        if any(True for _ in experiment.wants(plan, done)):
            return None
        samples = experiment.samples(plan, done)
        picture = experiment.picture(plan, done) if isinstance(experiment, Depicted) else None
        groups = experiment.groups if isinstance(experiment, Grouped) else ()
        there = {line.group for line in samples}
        return cls(
            experiment,
            samples,
            picture,
            tuple(dict.fromkeys(group for group in groups if group not in there)),
            Effort(len(done.keys_asked), sum(store.spent_s(key) for key in done.keys_asked)),
        )

    @classmethod
    def so_far(cls, experiment: Experiment, plan: Plan, store: Store) -> Outcome | None:
        """Ask it with as many repeats, up to the plan's, as all of its work is done for; None for none."""
        fewer = [] if plan.is_quick else range(plan.repeats - 1, 0, -1)
        plans = [plan, *(plan.repeated(count) for count in fewer)]
        return next((found for one in plans if (found := cls.of(experiment, one, store))), None)


def missing(units: Iterable[Unit], done: Done) -> list[Unit]:
    """Keep the units that have no result."""
    return [unit for unit in units if unit.key not in done]
