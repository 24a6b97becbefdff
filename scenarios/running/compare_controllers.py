"""Controllers against each other: the same scenario, the same seeds, and how sure the differences are."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.registry import make_behaviour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.tracker_by_name import camera_names
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.run import RunOptions
from peopleboy.scenarios.running.run_task import RunTask, play, unfinished
from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own

GROUPS = ("following", "corridor", "comfort")  # of metrics.json: how the robot drove


@dataclass(frozen=True, slots=True)
class Controller:
    """A behaviour by name or module:Class, and the tracker that is its eyes; written behaviour@tracker."""

    behaviour: str
    eyes: str

    def __str__(self) -> str:
        """Leave the usual tracker out."""
        return self.behaviour if self.eyes == DEFAULT_TRACKER else f"{self.behaviour}@{self.eyes}"


Figures = Mapping[str, float]


def parse_controller(text: str) -> Controller:
    """Read behaviour or behaviour@tracker.

    Raises:
        BadInput: there is no such behaviour or tracker.
    """
    behaviour, at, eyes = text.strip().partition("@")
    make_behaviour(behaviour)
    controller = Controller(behaviour, eyes if at else DEFAULT_TRACKER)
    camera_names(controller.eyes)  # refuses an unknown name
    return controller


def compare(
    scenario: str,
    controllers: Sequence[Controller],
    seeds: Iterable[int],
    out: Path,
    workers: Workers,
    physics: str | None = None,
    boxes: BoxKind = BoxKind.TORSO,
    *,
    overwrite: bool,
) -> dict[Controller, list[Figures]]:
    """Run a scenario with every controller and seed, and collect how the robot drove.

    A comparison that was killed goes on where it was.

    Args:
        scenario: name or path.
        controllers: who drives.
        seeds: the same for all of them.
        out: where the runs' folders go, each CONTROLLER-SEED.
        workers: who does the runs.
        physics: what moves the robot; None for what the scenario says.
        boxes: what boxes of trackers of your own are drawn round; those of ours are round torsos.
        overwrite: whether earlier runs are replaced.

    Returns:
        For each controller the figures of each seed, NaN for what is undefined.

    Raises:
        BadInput: as for a single run, a controller is named twice, no tracker is one of your own whose
            boxes are round whole people, or a complete run in the place of one is another one.
        TasksFailed: some runs failed.
    """
    if len(set(controllers)) < len(controllers):
        raise BadInput(f"--controllers {','.join(map(str, controllers))}: each may be there once only")
    if boxes is not BoxKind.TORSO and not any(is_own(controller.eyes) for controller in controllers):
        raise BadInput(f"--boxes {boxes}: no controller sees by a tracker of your own; leave it out")
    loaded = load_scenario(scenario)
    if physics is not None:
        loaded = loaded.moved_by(physics)
    tasks = {
        (controller, seed): RunTask(
            loaded.steered_by(controller.behaviour),
            RunOptions(
                seed=seed,
                out=out / f"{controller}-{seed}".replace(":", "."),
                tracker=controller.eyes,
                boxes=boxes if is_own(controller.eyes) else BoxKind.TORSO,
                record=False,
                overwrite=overwrite,
            ),
        )
        for seed in seeds
        for controller in controllers
    }
    play(unfinished(list(tasks.values())), workers, loaded.name)
    return {
        controller: [figures_of(task.options.out) for (who, _), task in tasks.items() if who == controller]
        for controller in controllers
    }


def intervals(runs: Sequence[Figures], rng: np.random.Generator) -> dict[str, Interval]:
    """Give every figure's mean over some runs, with its interval."""
    names = list(dict.fromkeys(name for figures in runs for name in figures))
    return {name: bootstrap([figures.get(name, math.nan) for figures in runs], rng) for name in names}


def figures_of(folder: Path) -> dict[str, float]:
    """Read from a run's folder how the robot drove; yes and no are 1 and 0."""
    metrics = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    groups = [metrics[name] for name in GROUPS if name in metrics]
    return {
        name: math.nan if value is None else float(value) for group in groups for name, value in group.items()
    }
