"""Run a tracker on a scenario with several seeds, and score it, in one call."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.footage.box_kinds import BoxKind


def evaluate_run(
    scenario: str | Path | Scenario,
    tracker: str | type | None = None,
    seeds: Iterable[int] = (0,),
    *,
    boxes: BoxKind | str = BoxKind.TORSO,
) -> Scores:
    """Run a scenario with each seed and score the tracker against the ground truth.

    Args:
        scenario: a library name, the path of a YAML file, or a loaded scenario.
        tracker: a name, "module:Class", or your own class; None for the scenario's, or the default.
        seeds: seeds of the runs, such as range(10).
        boxes: what the boxes of your own tracker enclose: "torso" or "whole".

    Returns:
        The scores over the frames of all runs.

    Raises:
        BadInput: the scenario or the tracker is unknown, or there are no seeds.
    """
    loaded = load_scenario(scenario)
    name = f"{tracker.__module__}:{tracker.__qualname__}" if isinstance(tracker, type) else tracker
    scores = []
    for seed in seeds:
        with TemporaryDirectory() as folder:
            options = RunOptions(
                seed=seed, out=Path(folder) / "run", tracker=name, boxes=BoxKind(boxes), record=False
            )
            scores.append(run(loaded, options).people)
    if not scores:
        raise BadInput("seeds: must have at least one seed, such as range(10), got none")
    return combine(scores)
