"""The whole of it: let trackers with other values see the same films, and leave curves and a page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.studies.reproductions.experiments.tracking import add_up, metric
from peopleboy.studies.reproductions.measuring.run_units import open_store, run_units
from peopleboy.studies.reproductions.measuring.units import FilmUnit, TrackUnit
from peopleboy.studies.reproductions.tuning.tuned import CRITERION, Tuned
from peopleboy.studies.reproductions.tuning.tuned_page import write_tuned_page
from peopleboy.studies.reproductions.tuning.tuned_parameters import Parameter

FIRST_SEED = 100  # the data sets that figures are reported on have seeds below 10
RESULTS = "units.jsonl"
FIGURES = "tuned.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingFilms:
    """What the trackers see.

    Attributes:
        cache: where rendered frames are kept.
        seeds: films of each scenario.
        seconds: of each film, at most.
    """

    cache: Path
    seeds: int = 4
    seconds: float = 45.0

    def plays(self, scenario: str) -> list[SuiteRun]:
        """List the films of a scenario."""
        whole = load_scenario(scenario)
        cut = whole.lasting(min(self.seconds, whole.duration_s))
        return [SuiteRun(cut, FIRST_SEED + number) for number in range(self.seeds)]


def tune(
    parameters: Sequence[Parameter], films: TrainingFilms, out: Path, workers: Workers
) -> tuple[Path, list[Tuned]]:
    """Try every value of the parameters, one parameter at a time, all else as printed.

    Whoever is killed begins again with the same folder: results that are there are taken from there.

    Returns:
        The page, and what came out.

    Raises:
        BadInput: the folder or the cluster cannot be used.
        TasksFailed: some of it failed, after all else was done.
    """
    store = open_store(out / RESULTS)
    plays = {one.scenario: films.plays(one.scenario) for one in parameters}
    shots = [FilmUnit(play, films.cache) for several in plays.values() for play in several]
    run_units(shots, store, workers)
    run_units([unit for one in parameters for unit in _units(one, films)], store, workers)
    tuned = [_tuned(one, films, store) for one in parameters]
    plain = {one.parameter.name: one.plain() for one in tuned}
    (out / FIGURES).write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    seeds = f"{FIRST_SEED} to {FIRST_SEED + films.seeds - 1}"
    return write_tuned_page(out, tuned, f"Seeds {seeds}, {films.seconds:g} s of each film at most."), tuned


def _units(parameter: Parameter, films: TrainingFilms) -> list[TrackUnit]:
    return [unit for value in parameter.values for unit in _units_of(parameter, value, films)]


def _units_of(parameter: Parameter, value: str, films: TrainingFilms) -> list[TrackUnit]:
    """List the work of one value: every film once, each with random numbers of its own."""
    plays = films.plays(parameter.scenario)
    setting = parameter.setting(value)
    return [TrackUnit(play, films.cache, setting, number) for number, play in enumerate(plays)]


def _tuned(parameter: Parameter, films: TrainingFilms, store: Store) -> Tuned:
    accuracy = {
        value: np.array(
            [
                metric(add_up([store[unit.key]["ignore"]]), CRITERION)
                for unit in _units_of(parameter, value, films)
            ]
        )
        for value in parameter.values
    }
    return Tuned(parameter, accuracy)
