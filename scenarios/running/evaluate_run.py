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
    detector: str | type | None = None,
    boxes: BoxKind | str = BoxKind.TORSO,
) -> Scores:
    """Run a scenario with each seed and score the tracker against the ground truth.

    Args:
        scenario: a library name, the path of a YAML file, or a loaded scenario.
        tracker: a name, "module:Class", or your own class; None for the scenario's, or the default.
        seeds: seeds of the runs, such as range(10).
        detector: "module:Class", or your own class, that replaces the tracker's detector; None for its own.
        boxes: what the boxes of your own tracker or detector enclose: "torso" or "whole".

    Returns:
        The scores over the frames of all runs.

    Raises:
        BadInput: the scenario or the tracker is unknown, or there are no seeds.
    """
    loaded = load_scenario(scenario)
    scores = []
    for seed in seeds:
        with TemporaryDirectory() as folder:
            options = RunOptions(
                seed=seed,
                out=Path(folder) / "run",
                tracker=_name_of(tracker),
                detector=_name_of(detector),
                boxes=BoxKind(boxes),
                record=False,
            )
            scores.append(run(loaded, options).people)
    if not scores:
        raise BadInput("seeds: must have at least one seed, such as range(10), got none")
    return combine(scores)


def _name_of(own: str | type | None) -> str | None:
    """Return the name by which commands select a class."""
    return f"{own.__module__}:{own.__qualname__}" if isinstance(own, type) else own
