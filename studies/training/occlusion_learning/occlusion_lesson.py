"""The whole lesson: run scenarios, learn the order, print what came out, write the table."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.store import Store, code_digest
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.occlusion_learning import occlusion_pairs
from peopleboy.studies.training.occlusion_learning.occlusion_pairs import PairExample
from peopleboy.studies.training.occlusion_learning.pair_files import read_pairs, write_pairs
from peopleboy.studies.training.occlusion_learning.pair_task import PairTask, examples_of
from peopleboy.studies.training.occlusion_learning.show_training import print_best, print_trials
from peopleboy.studies.training.occlusion_learning.train_occlusion import (
    SCENARIOS,
    check_examples,
    learn,
    run_trials,
)
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.occlusion.learned_table import TABLES
from peopleboy.tracker.contour.variants import CONTOUR, THESIS_OCCLUSION

PUPILS: dict[str, TrackerConfig] = {"contour": CONTOUR, "thesis": THESIS_OCCLUSION}
"""The trackers that put people in order, by name."""


def give_lesson(
    out: Path, tracker: str, seeds: int, workers: Workers, *, triplets: bool, again: bool, ship: bool
) -> Path:
    """Learn from scenarios and leave the examples and the learned table in a folder.

    Examples that an earlier lesson left there are used as they are.

    Args:
        out: the folder.
        tracker: name of the tracker to learn for, one that puts people in order.
        seeds: runs of each scenario.
        workers: who runs them.
        triplets: whether to try weighted triplets as well.
        again: whether to run the scenarios even if the examples are there.
        ship: whether to put the table in the place of the tracker's own.

    Returns:
        The table's path.

    Raises:
        BadInput: a tracker that has nothing to learn, a path that cannot be used, or too few examples.
        TasksFailed: some runs failed, after all others were done.
    """
    if tracker not in PUPILS:
        raise BadInput(f"--tracker {tracker}: must be one that orders people: {', '.join(PUPILS)}")
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
    examples = _examples(out / "pairs.csv", tracker, seeds, workers, again=again)
    for path in out.glob("*.jsonl"):
        path.unlink()
    check_examples(examples)
    with Console(stderr=True).status("learning"):
        trials = list(run_trials(examples, most=3 if triplets else 2))
        learned = learn(examples)
    print_trials(trials)
    print_best(learned)
    path = (TABLES if ship else out) / f"{tracker}.yaml"
    learned.save(path)
    return path


def _examples(path: Path, tracker: str, seeds: int, workers: Workers, *, again: bool) -> list[PairExample]:
    """Read the examples, or run the scenarios and write them; what a killed call has collected is used."""
    if path.exists() and not again:
        return read_pairs(path)
    store = Store(path.with_suffix(".jsonl"), code_digest(*map(Path, (occlusion_pairs.__file__, __file__))))
    tasks = [PairTask(name, seed, tracker, PUPILS[tracker]) for seed in range(seeds) for name in SCENARIOS]
    missing = [task for task in tasks if task.name not in store]
    work_through(missing, workers, path.stem, lambda task, result: store.add(task.name, result))
    examples = [
        example
        for task in tasks
        for example in examples_of(task.scenario, task.seed, store[task.name]["pairs"])
    ]
    write_pairs(path, examples)
    return examples
