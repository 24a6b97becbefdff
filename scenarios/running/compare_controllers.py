"""Run several controllers in the same scenarios and seeds."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.tracker_by_name import tracker_cameras
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.many_runs import RunTask, play, unfinished
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.tables.drive_comparison import DriveFigures, figures_of
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.trackers import DEFAULT_TRACKER, is_own


@dataclass(frozen=True, slots=True)
class Controller:
    """A behaviour by name or module:Class, and the tracker that it uses; written behaviour@tracker."""

    behaviour: str
    eyes: str

    def __str__(self) -> str:
        """Return the name, without the tracker if it is the default."""
        return self.behaviour if self.eyes == DEFAULT_TRACKER else f"{self.behaviour}@{self.eyes}"


def parse_controller(text: str) -> Controller:
    """Parse a controller from behaviour or behaviour@tracker.

    Raises:
        BadInput: the behaviour or the tracker is unknown.
    """
    behaviour, at, eyes = text.strip().partition("@")
    make_behaviour(behaviour)
    controller = Controller(behaviour, eyes if at else DEFAULT_TRACKER)
    tracker_cameras(controller.eyes)  # raises for an unknown name
    return controller


def compare(
    scenario: str | Path | Scenario,
    controllers: Sequence[Controller],
    seeds: Iterable[int],
    options: RunOptions,
    workers: Workers,
) -> dict[str, list[DriveFigures]]:
    """Run a scenario with every controller and seed, and collect the metrics of how the robot drove.

    A killed comparison resumes when it is called again.

    Args:
        scenario: name, path, or a loaded scenario.
        controllers: the controllers to compare.
        seeds: seeds, the same for all controllers.
        options: options of a run; `out` is the folder of all runs, each in CONTROLLER-SEED, and `boxes` is
            for your own trackers, because the shipped ones give torso boxes.
        workers: workers that execute the runs.

    Returns:
        For each controller by name, the metrics of each seed; undefined ones are NaN.

    Raises:
        BadInput: a run is invalid, a controller is given twice, `boxes` asks for whole people but no tracker
            is your own, or the folder of a run holds another complete run.
        TasksFailed: some runs failed.
    """
    if len(set(controllers)) < len(controllers):
        raise BadInput(f"--controllers {','.join(map(str, controllers))}: give each only once")
    if options.boxes is not BoxKind.TORSO and not any(is_own(controller.eyes) for controller in controllers):
        raise BadInput(f"--boxes {options.boxes}: no controller uses your own tracker; leave it out")
    loaded = load_scenario(scenario)
    tasks = {
        (controller, seed): RunTask(loaded, _options(options, controller, seed))
        for seed in seeds
        for controller in controllers
    }
    play(unfinished(list(tasks.values())), workers, loaded.name)
    return {
        str(controller): [
            figures_of(task.options.out) for (who, _), task in tasks.items() if who == controller
        ]
        for controller in controllers
    }


def _options(options: RunOptions, controller: Controller, seed: int) -> RunOptions:
    return replace(
        options,
        seed=seed,
        out=options.out / f"{controller}-{seed}".replace(":", "."),
        behaviour=controller.behaviour,
        tracker=controller.eyes,
        boxes=options.boxes if is_own(controller.eyes) else BoxKind.TORSO,
        record=False,
    )
