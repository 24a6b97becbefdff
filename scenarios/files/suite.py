"""Suites: lists of scenarios with seeds, such as the data sets modelled on those of the thesis."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, with_config

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.library import SUITES, suite_names
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.recorded_drives import read_drive
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.validation import STRICT, validated
from peopleboy.settings import Word
from peopleboy.wording import hint

DRIVES = SUITES / "drives"


@dataclass(frozen=True, slots=True, kw_only=True)
class EntrySpec:
    """A scenario of a suite, run once with each seed."""

    scenario: Annotated[Word, Field(description="name in the library")]
    seeds: Annotated[
        tuple[Annotated[int, Field(ge=0)], ...],
        Field(strict=False, min_length=1, description="seeds of the runs"),
    ]
    duration_s: Annotated[
        float | None, Field(gt=0.0, le=36000.0, description="duration that replaces the scenario's own")
    ] = None
    repeats_drive: Annotated[
        bool,
        Field(description="whether the robot replays the drive stored for this suite, scenario and seed"),
    ] = False


@with_config(STRICT)
@dataclass(frozen=True, slots=True, kw_only=True)
class SuiteSpec:
    """A suite file."""

    name: Annotated[Word, Field(description="name of the suite, one word; also used for folders")]
    description: Annotated[str, Field(min_length=1, max_length=1000, description="purpose of the suite")]
    runs: Annotated[tuple[EntrySpec, ...], Field(strict=False, min_length=1, description="scenarios to run")]


@dataclass(frozen=True, slots=True, eq=False)
class SuiteRun:
    """One run of a suite: a scenario, with the suite's duration, and a seed."""

    scenario: Scenario
    seed: int

    @property
    def name(self) -> str:
        """Name of the run's folder."""
        return f"{self.scenario.name}-{self.seed}"


def load_suite(name: str) -> SuiteSpec:
    """Read a suite by its name.

    Raises:
        BadInput: the suite is unknown, or its file is invalid.
    """
    if name not in suite_names():
        raise BadInput(f"unknown suite {name!r}; {hint(name, suite_names())}")
    data: dict[Any, Any] = read_yaml(SUITES / f"{name}.yaml")
    with found_in(file=f"suites/{name}.yaml"):
        return validated(SuiteSpec, data)


def runs_of(suite: SuiteSpec, *, with_drives: bool = True) -> Iterator[SuiteRun]:
    """Yield every run of a suite.

    Args:
        suite: the suite.
        with_drives: whether robots replay recorded drives where the suite asks for it.

    Raises:
        BadInput: a scenario or a drive is missing.
    """
    for entry in suite.runs:
        scenario = load_scenario(entry.scenario)
        if entry.duration_s is not None:
            scenario = scenario.lasting(entry.duration_s)
        for seed in entry.seeds:
            is_driven = entry.repeats_drive and with_drives
            drive = read_drive(drive_path(suite.name, entry.scenario, seed)) if is_driven else None
            yield SuiteRun(scenario if drive is None else scenario.driven(drive), seed)


def scenarios_of(names: Sequence[str]) -> list[Scenario]:
    """Load scenarios by name or path; the name of a suite stands for the scenarios of its runs.

    Raises:
        BadInput: a scenario is unknown or invalid, or two different ones have the same name.
    """
    found: dict[str, Scenario] = {}
    for name in names:
        loaded = _scenarios_in(name) if name in suite_names() else [load_scenario(name)]
        for scenario in loaded:
            before = found.setdefault(scenario.name, scenario)
            if before.resolved(before.seed) != scenario.resolved(before.seed):
                raise BadInput(f"{name}: another scenario is also called {scenario.name!r}; leave one out")
    return list(found.values())


def _scenarios_in(suite: str) -> list[Scenario]:
    """Return the different scenarios of a suite's runs, without recorded drives."""
    runs = runs_of(load_suite(suite), with_drives=False)
    return list({one.scenario.name: one.scenario for one in runs}.values())


def drive_path(suite: str, scenario: str, seed: int) -> Path:
    """Return the path of the recorded drive of a suite's run."""
    return DRIVES / f"{suite}-{scenario}-{seed}.parquet"
