"""What an experiment is: work to be done, and the samples that come of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.studies.distance_learning.image_errors import ImageErrors
from peopleboy.scenarios.studies.reproduce.measuring.units import Unit
from peopleboy.scenarios.studies.reproduce.measuring.workload import Plan

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


Figures = NDArray[np.float64] | ImageErrors
"""Of one line and column: (R,) one figure per repeat, or the errors of many images."""

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


@runtime_checkable
class Depicted(Protocol):
    """An experiment that has a picture of its own in place of a chart."""

    def picture(self, plan: Plan, done: Done) -> str | None:
        """Give the address of its picture, once all is done; None for none."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What an experiment has come to.

    Attributes:
        experiment: which one.
        samples: its figures.
        picture: address of a picture of its own; None for none.
    """

    experiment: Experiment
    samples: Samples
    picture: str | None = None

    @classmethod
    def of(cls, experiment: Experiment, plan: Plan, done: Done) -> Outcome:
        """Ask an experiment for all that it has, once all is done."""
        picture = experiment.picture(plan, done) if isinstance(experiment, Depicted) else None
        return cls(experiment, experiment.samples(plan, done), picture)


def missing(units: Iterable[Unit], done: Done) -> list[Unit]:
    """Keep the units that have no result."""
    return [unit for unit in units if unit.key not in done]
