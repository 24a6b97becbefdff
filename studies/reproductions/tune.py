"""Evaluate other values of the thesis's parameters on the same clips; write a curve of each and a page."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from pydantic import Field
from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.reproductions.canvas import finish, svg, svg_axes
from peopleboy.studies.reproductions.experiments.sequence_scores import USUAL
from peopleboy.studies.reproductions.experiments.tracking import add_sums, count_unit, metric, sequence_unit
from peopleboy.studies.reproductions.runner import RESULTS, rich_table
from peopleboy.studies.reproductions.source_page import HERE, rendered, span
from peopleboy.studies.reproductions.statistics import ResultDifference, margin, paired
from peopleboy.studies.reproductions.tracker_settings import Changes, TrackerSetting, changes_of
from peopleboy.studies.reproductions.units import Unit, open_store, run_units

# The reported data sets have seeds below 10: values chosen here must not be fitted to them.
FIRST_SEED: Final = 100
FIGURES: Final = "tuned.json"
PAGE: Final = "index.html"
CRITERION: Final = "AA"
"""Area accuracy, as in the thesis."""

_COLUMNS = ("parameter", "thesis", "printed", "best here", f"{CRITERION}, best less printed (95 %)", "")


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One of the parameters that the thesis optimised.

    Attributes:
        name: name on the command line.
        says: description.
        section: section of the thesis with its value.
        base: the tracker of that chapter, one of `BASES`.
        printed: the value in the thesis.
        values: changes of the tracker for each value; none for the printed one.
    """

    name: str
    says: str
    section: str
    base: str
    printed: str
    values: Mapping[str, Changes]

    @property
    def scenario(self) -> str:
        """Scenario of the chapter's data set with a standing robot, used with other seeds."""
        return "passers_by" if self.base == "thesis-single" else "hall_visits"

    def setting(self, value: str) -> TrackerSetting:
        """Return the tracker with this value."""
        return TrackerSetting(self.base, self.values[value])


def _parameter(name: str, declared: dict[str, Any]) -> Parameter:
    """Read a declaration; settings in `scales` change in proportion, not for the printed value."""
    scales, others, printed = (declared.pop(key, ()) for key in ("scales", "others", "printed"))
    if scales:
        own = {path: TrackerSetting(declared["base"]).value(path) for path in scales}
        declared["values"] = {
            f"{value:g}": {} if value == printed else {path: own[path] * value / printed for path in scales}
            for value in sorted([printed, *others])
        }
        printed = f"{printed:g}"
    values = {value: changes_of(changes) for value, changes in declared.pop("values").items()}
    return Parameter(name=name, printed=printed, values=values, **declared)


PARAMETERS: Final[Mapping[str, Parameter]] = {
    name: _parameter(name, declared) for name, declared in read_yaml(HERE / "tuned_parameters.yaml").items()
}
"""Parameters by name, in the thesis's order."""


def chosen_parameters(names: Sequence[str]) -> list[Parameter]:
    """Find parameters by name; all if none is named.

    Raises:
        BadInput: a parameter is unknown.
    """
    for name in names:
        if name not in PARAMETERS:
            raise BadInput(f"--parameter: unknown parameter {name!r}; choose from {', '.join(PARAMETERS)}")
    return [one for name, one in PARAMETERS.items() if not names or name in names]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingFilms:
    """The clips of the evaluation.

    Attributes:
        cache: folder of rendered frames.
        seeds: seeds of the clips of each scenario.
    """

    cache: Path
    seeds: range = range(FIRST_SEED, FIRST_SEED + 4)
    seconds: Annotated[float, Field(ge=5.0, description="Maximum duration of a clip, in seconds.")] = 45.0

    def plays(self, scenario: str) -> list[SuiteRun]:
        """Return the clips of a scenario."""
        whole = load_scenario(scenario)
        cut = whole.lasting(min(self.seconds, whole.duration_s))
        return [SuiteRun(cut, seed) for seed in self.seeds]

    def units(self, parameter: Parameter, value: str) -> list[Unit]:
        """Return the units of one value: every clip once, each with its own random stream."""
        plays, setting = self.plays(parameter.scenario), parameter.setting(value)
        return [sequence_unit(play, self.cache, setting, number) for number, play in enumerate(plays)]


@dataclass(frozen=True, slots=True, eq=False)
class Tuned:
    """The curve of one parameter.

    Attributes:
        parameter: the parameter.
        accuracy: area accuracy [%] (R,) of each value, one per clip.
    """

    parameter: Parameter
    accuracy: Mapping[str, NDArray[np.float64]]

    @property
    def best(self) -> str:
        """The value with the highest mean; among equal ones the printed one, then the first."""
        printed = self.parameter.printed
        return max(self.accuracy, key=lambda value: (self.accuracy[value].mean(), value == printed))

    @property
    def gain(self) -> ResultDifference:
        """Difference between the best value and the printed one."""
        return paired(CRITERION, self.accuracy[self.best], self.accuracy[self.parameter.printed])

    @property
    def verdict(self) -> str:
        """Return the conclusion in a few words."""
        if self.best == self.parameter.printed:
            return "no other value is better"
        gain = self.gain
        if gain.is_sure and gain.low > 0:
            return f"{self.best} is better"
        is_flat = gain.is_sure and gain.high <= margin(CRITERION, 0.0)
        return "little effect" if is_flat else "undecided"

    def plain(self) -> dict[str, Any]:
        """Return the curve as plain data; unknown bounds are None."""
        gain, printed = self.gain, self.parameter.printed
        return {
            "printed": float(printed),
            "best": float(self.best),
            "as_printed": float(self.accuracy[printed].mean()),
            "at_best": float(self.accuracy[self.best].mean()),
            "gain": gain.by,
            "low": gain.low if gain.is_sure else None,
            "high": gain.high if gain.is_sure else None,
            "verdict": self.verdict,
            CRITERION: {value: figures.tolist() for value, figures in self.accuracy.items()},
        }


def tune(
    parameters: Sequence[Parameter], films: TrainingFilms, out: Path, workers: Workers
) -> tuple[Path, list[Tuned]]:
    """Evaluate every value of the parameters, one parameter at a time, with all others as printed.

    A killed call resumes in the same folder and reuses its results.

    Returns:
        The page, and the curves.

    Raises:
        BadInput: the folder or the cluster cannot be used.
        TasksFailed: some units failed, after all others were completed.
    """
    store = open_store(out / RESULTS)
    plays = {one.scenario: films.plays(one.scenario) for one in parameters}
    run_units(
        [count_unit(play, films.cache) for several in plays.values() for play in several], store, workers
    )
    work = [unit for one in parameters for value in one.values for unit in films.units(one, value)]
    run_units(work, store, workers)
    tuned = [_tuned(one, films, store) for one in parameters]
    plain = {one.parameter.name: one.plain() for one in tuned}
    (out / FIGURES).write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    seeds = f"{films.seeds.start} to {films.seeds.stop - 1}"
    return write_tuned_page(out, tuned, f"Seeds {seeds}, at most {films.seconds:g} s of each clip."), tuned


def _tuned(parameter: Parameter, films: TrainingFilms, store: Store) -> Tuned:
    def accuracy(value: str) -> NDArray[np.float64]:
        results = [store[unit.key][USUAL] for unit in films.units(parameter, value)]
        return np.array([metric(add_sums([one]), CRITERION) for one in results])

    return Tuned(parameter, {value: accuracy(value) for value in parameter.values})


def write_tuned_page(out: Path, tuned: Sequence[Tuned], films: str) -> Path:
    """Write NAME.svg for each parameter, and a page with all of them."""
    for one in tuned:
        name = one.parameter.name
        (out / f"{name}.svg").write_bytes(svg(_curve(one), name))
    page = out / PAGE
    text = rendered(
        "tuned.html.jinja",
        films=films,
        columns=_COLUMNS,
        rows=[_cells(one) for one in tuned],
        parameters=[one.parameter.name for one in tuned],
        criterion=CRITERION,
    )
    page.write_text(f"{text}\n", encoding="utf-8")
    return page


def print_tuned(tuned: Sequence[Tuned]) -> None:
    """Print the printed value of each parameter, the best one, and their difference with its interval."""
    table = rich_table(_COLUMNS, map(_cells, tuned))
    Console(width=None if sys.stdout.isatty() else 140, highlight=False).print(table)


def _cells(one: Tuned) -> tuple[str, ...]:
    parameter = one.parameter
    gain = span(one.gain, CRITERION) if one.best != parameter.printed else "-"
    return (parameter.name, parameter.section, parameter.printed, one.best, gain, one.verdict)


def _curve(one: Tuned) -> Figure:
    """Draw area accuracy over the values, at equal distances."""
    figure, axes = svg_axes(4.5, 2.8)
    values = list(one.accuracy)
    means = [figures.mean() for figures in one.accuracy.values()]
    spreads = [figures.std(ddof=1) if figures.size > 1 else 0.0 for figures in one.accuracy.values()]
    axes.axvline(values.index(one.parameter.printed), color="#999999", linestyle="--", linewidth=1)
    axes.errorbar(np.arange(len(values)), means, spreads, color="#d95f02", marker="o", capsize=3)
    axes.set_xticks(range(len(values)), values)
    axes.set_xlabel(f"{one.parameter.name}: {one.parameter.says}", fontsize=8)
    axes.set_ylabel(f"{CRITERION} [%]", fontsize=8)
    axes.set_ylim(bottom=0.0)
    finish(axes)
    return figure
