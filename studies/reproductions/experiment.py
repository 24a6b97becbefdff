"""Tables and figures of a source: printed values, how they are measured, and the results."""

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
"""Method of the printed values, unless the source has several computers or methods."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a table.

    Attributes:
        group: the varied quantity, as in the source: a data set, a number of samples, a step.
        method: the method of the values: a tracker, or a counting rule.
    """

    group: str
    method: str


@dataclass(frozen=True, slots=True, eq=False)
class Jackknife:
    """A value of a single repeat, and its leave-one-out values.

    Attributes:
        whole: value of all sequences.
        without: (F,) values without one of the sequences.
        suites: names of the data sets; equal for values of the same sequences.
    """

    whole: float
    without: Floats
    suites: tuple[str, ...]

    @property
    def by_sequence(self) -> Floats:
        """Return the jackknife pseudo-values (F,), one for each sequence.

        Source: Miller, "The jackknife - a review", Biometrika 61, 1974.
        """
        count = len(self.without)
        return count * self.whole - (count - 1) * self.without


Values = Floats | Jackknife | ImageErrors
"""Values of a line and column: (R,) one per repeat, a single repeat's, or errors of images."""

Samples = Mapping[Line, Mapping[str, Values]]
"""Values of each line, by name of the column."""

Row = Mapping[str, float]


def as_columns(rows: Iterable[Row]) -> dict[str, Floats]:
    """Convert rows, one per repeat, to columns (R,)."""
    listed = list(rows)
    return {name: np.array([row[name] for row in listed], dtype=np.float64) for name in listed[0]}


def ratio(part: float, whole: float) -> float:
    """Return a ratio; NaN if the denominator is 0."""
    return float(part / whole) if whole else float("nan")


def mean(values: Floats | Sequence[float]) -> float:
    """Return the mean; NaN without values."""
    return float(np.mean(values)) if len(values) else float("nan")


Number = Annotated[float, Field(allow_inf_nan=False)]
Texts = Annotated[tuple[str, ...], Field(strict=False)]


class PrintedLine(Strict):
    """A line of a printed table; further keys are columns: a mean, or mean and deviation."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Number | Annotated[tuple[Number, Number], Field(strict=False)]]

    group: str
    """varied quantity"""
    method: str = SOURCE
    """method, where the source has several, such as computers"""

    @property
    def values(self) -> dict[str, tuple[float, float | None]]:
        """Return mean and deviation by column."""
        return {
            name: value if isinstance(value, tuple) else (value, None)
            for name, value in (self.__pydantic_extra__ or {}).items()
        }


class Claim(Strict):
    """A claim of the source that can be checked."""

    says: str
    """the claim in plain words"""
    metric: str
    """column that it refers to"""
    groups: Annotated[tuple[str, str], Field(strict=False)]
    """the first group is compared with the second"""
    expect: Literal["more", "less", "alike", "no less", "differs"]
    """expected relation of the first group to the second; "differs" for either direction"""
    by: Number | None = None
    """difference in points that the source gives"""
    times: Number | None = None
    """ratio of the first value to the second in the source"""
    tested: bool = False
    """whether the source reports a paired t-test"""


class Experiment(Strict):
    """A table or figure of a source, and how it is measured; `catalogue` reads them from files."""

    id: str
    """such as "figure-4.8" or "paper-table-1\""""
    title: str
    source: str
    note: str = ""
    caption: str = ""
    """description of the source's figure, if it is a picture"""
    values: Annotated[tuple[PrintedLine, ...], Field(strict=False)] = ()
    claims: Annotated[tuple[Claim, ...], Field(strict=False)] = ()
    why: str = ""
    """differences from the source, and their reasons"""
    groups: Texts = ()
    """varied values of a full run, in the order of its lines; a quick run omits some"""
    measure: Callable[[Measurement], Samples] | None = None
    """measures the lines of the table; None for a figure without numbers"""
    draw: Callable[[Measurement], Figure | str | None] | None = None
    """draws a picture, or its data URL; otherwise the lines are plotted"""
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
    """Effort of an experiment, including units of work that it shares with others.

    Attributes:
        units: number of units of work.
        seconds: [s] processor time.
    """

    units: int
    seconds: float


@dataclass(frozen=True, slots=True, eq=False)
class ExperimentOutcome:
    """Result of a finished experiment.

    Attributes:
        experiment: the experiment.
        samples: its values.
        picture: data URL of its own picture; None for none.
        left_out: groups of a full run that are missing.
        effort: its effort; None if unknown.
    """

    experiment: Experiment
    samples: Samples
    picture: str | None = None
    left_out: tuple[str, ...] = ()
    effort: Effort | None = None

    @property
    def repeats(self) -> int | None:
        """Number of values of each mean: repeats, splits or turns; None without any."""
        sizes = [
            1 if isinstance(values, Jackknife) else values.size
            for values in self._values()
            if not isinstance(values, ImageErrors)
        ]
        return max(sizes, default=None)

    @property
    def sequences(self) -> int | None:
        """Number of sequences of the intervals; None for intervals over repeats."""
        return max((len(one.without) for one in self._values() if isinstance(one, Jackknife)), default=None)

    def _values(self) -> Iterator[Values]:
        return (values for row in self.samples.values() for values in row.values())

    @classmethod
    def of(cls, experiment: Experiment, plan: Plan, store: Store) -> "ExperimentOutcome":
        """Measure and draw an experiment from the stored results.

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
        """Measure with as many repeats as all units have completed, up to the plan's; None without any."""
        fewer: Sequence[int] = () if plan.is_quick else range(plan.repeats - 1, 0, -1)
        for one in (plan, *map(plan.repeated, fewer)):
            try:
                return cls.of(experiment, one, store)
            except Unfinished:
                continue
        return None
