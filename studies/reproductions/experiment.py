"""Tables and figures of a source: what is printed, how it is measured, and what the measurement gave."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator

from peopleboy.scenarios.files.validation import Strict
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.studies.reproductions.canvas import png_address
from peopleboy.studies.reproductions.image_errors import ImageErrors
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.units import Measurement, Unfinished

SOURCE = "source"
"""Whose the printed values are, unless the source has several computers or methods."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a table.

    Attributes:
        group: what is varied, as in the source: a data set, a number of samples, a step.
        method: whose values these are: a tracker, or a way to count.
    """

    group: str
    method: str


@dataclass(frozen=True, slots=True, eq=False)
class Jackknife:
    """A value of a single repeat, and what it would be without each of its sequences.

    Attributes:
        whole: of all sequences.
        without: (F,) of all but one.
        suites: names of the data sets that they are; values of the same sequences have the same.
    """

    whole: float
    without: Floats
    suites: tuple[str, ...]

    @property
    def by_sequence(self) -> Floats:
        """Return the pseudo-values (F,), which stand for values of each sequence by itself.

        Source: Miller, "The jackknife - a review", Biometrika 61, 1974.
        """
        count = len(self.without)
        return count * self.whole - (count - 1) * self.without


Values = Floats | Jackknife | ImageErrors
"""Of one line and column: (R,) one value per repeat, that of a single one, or errors of images."""

Samples = Mapping[Line, Mapping[str, Values]]
"""Of each line, by the column's name."""

Row = Mapping[str, float]


def as_columns(rows: Iterable[Row]) -> dict[str, Floats]:
    """Turn rows, one per repeat, into columns (R,)."""
    listed = list(rows)
    return {name: np.array([row[name] for row in listed], dtype=np.float64) for name in listed[0]}


def ratio(part: float, whole: float) -> float:
    """Return a share; NaN of nothing."""
    return float(part / whole) if whole else float("nan")


def mean(values: Floats | Sequence[float]) -> float:
    """Return the mean; NaN of nothing."""
    return float(np.mean(values)) if len(values) else float("nan")


Number = Annotated[float, Field(allow_inf_nan=False)]
Texts = Annotated[tuple[str, ...], Field(strict=False)]


class PrintedLine(Strict):
    """A line of a printed table; further keys are columns: a mean, or mean and deviation."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Number | Annotated[tuple[Number, Number], Field(strict=False)]]

    group: str
    """what is varied"""
    method: str = SOURCE
    """whose values, where the source has several, such as computers"""

    @property
    def values(self) -> dict[str, tuple[float, float | None]]:
        """Return mean and deviation by column."""
        return {
            name: value if isinstance(value, tuple) else (value, None)
            for name, value in (self.__pydantic_extra__ or {}).items()
        }


class Claim(Strict):
    """A sentence of the source that can be checked."""

    says: str
    """in our words"""
    metric: str
    """column that it is about"""
    groups: Annotated[tuple[str, str], Field(strict=False)]
    """the first compared with the second"""
    expect: Literal["more", "less", "alike", "no less", "differs"]
    """what the first is, or that they differ either way"""
    by: Number | None = None
    """difference in points that the source gives"""
    times: Number | None = None
    """how many times the second's value the source says that the first's is"""
    tested: bool = False
    """whether the source has a paired t-test"""


class Experiment(Strict):
    """A table or figure of a source beside what measures it again; `catalogue` reads them from files."""

    id: str
    """such as "figure-4.8" or "paper-table-1\""""
    title: str
    source: str
    note: str = ""
    caption: str = ""
    """what the source's figure shows, where it is a picture"""
    values: Annotated[tuple[PrintedLine, ...], Field(strict=False)] = ()
    claims: Annotated[tuple[Claim, ...], Field(strict=False)] = ()
    why: str = ""
    """what differs from the source, and why"""
    groups: Texts = ()
    """what a full run varies, in the order of its lines; a quick run leaves some out"""
    measure: Callable[[Measurement], Samples] | None = None
    """gives the lines of the table; None for a figure without numbers"""
    draw: Callable[[Measurement], Figure | str | None] | None = None
    """gives a picture of its own, or its address; otherwise the lines are plotted"""
    chart: Literal["bars", "lines", "none"] = "none"
    """how the lines are plotted"""
    plotted: Texts = ()
    """columns that are plotted"""

    @model_validator(mode="after")
    def _says_something(self) -> "Experiment":
        if not (self.values or self.claims or self.caption):
            raise ValueError("give values, claims or the caption of a picture")
        return self

    def printed(self, column: str) -> dict[str, tuple[float, float | None]]:
        """Return the source's own values of a column by group: mean and deviation."""
        return {
            line.group: line.values[column]
            for line in self.values
            if line.method == SOURCE and column in line.values
        }


@dataclass(frozen=True, slots=True)
class Effort:
    """What an experiment took, with the runs that it shares with others.

    Attributes:
        units: of work.
        seconds: [s] of processor time for them.
    """

    units: int
    seconds: float


@dataclass(frozen=True, slots=True, eq=False)
class ExperimentOutcome:
    """What a finished experiment gave.

    Attributes:
        experiment: which one.
        samples: its values.
        picture: address of a picture of its own; None for none.
        left_out: groups of a full run that this one lacks.
        effort: what it took; None if that is not known.
    """

    experiment: Experiment
    samples: Samples
    picture: str | None = None
    left_out: tuple[str, ...] = ()
    effort: Effort | None = None

    @property
    def repeats(self) -> int | None:
        """How many values each mean is of: repeats, splits or turns; None where there are none."""
        sizes = [
            1 if isinstance(values, Jackknife) else values.size
            for values in self._values()
            if not isinstance(values, ImageErrors)
        ]
        return max(sizes, default=None)

    @property
    def sequences(self) -> int | None:
        """Over how many sequences the intervals are; None where they are over repeats."""
        return max((len(one.without) for one in self._values() if isinstance(one, Jackknife)), default=None)

    def _values(self) -> Iterator[Values]:
        return (values for row in self.samples.values() for values in row.values())

    @classmethod
    def of(cls, experiment: Experiment, plan: Plan, store: Store) -> "ExperimentOutcome":
        """Measure and draw an experiment from the results that there are.

        Raises:
            Unfinished: some of its units have not run.
        """
        using = Measurement(plan, store)
        samples = experiment.measure(using) if experiment.measure else {}
        drawn = experiment.draw(using) if experiment.draw else None
        picture = png_address(drawn) if isinstance(drawn, Figure) else drawn
        there = {line.group for line in samples}
        left_out = tuple(group for group in experiment.groups if group not in there)
        effort = Effort(len(using.asked), sum(store.spent_s(key) for key in using.asked))
        return cls(experiment, samples, picture, left_out, effort)

    @classmethod
    def so_far(cls, experiment: Experiment, plan: Plan, store: Store) -> "ExperimentOutcome | None":
        """Measure with as many repeats, up to the plan's, as all units have run for; None for none."""
        fewer: Sequence[int] = () if plan.is_quick else range(plan.repeats - 1, 0, -1)
        for one in (plan, *map(plan.repeated, fewer)):
            try:
                return cls.of(experiment, one, store)
            except Unfinished:
                continue
        return None
