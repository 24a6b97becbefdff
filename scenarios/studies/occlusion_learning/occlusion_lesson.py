"""The whole lesson: run scenarios, learn the order, print what came out, write the table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.out_folder import writing_to
from peopleboy.scenarios.studies.occlusion_learning.occlusion_pairs import PairExample, collect
from peopleboy.scenarios.studies.occlusion_learning.pair_files import read_pairs, write_pairs
from peopleboy.scenarios.studies.occlusion_learning.show_training import print_best, print_trials
from peopleboy.scenarios.studies.occlusion_learning.train_occlusion import (
    TRAINING,
    UNSEEN,
    check_examples,
    learn,
    run_trials,
)
from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.occlusion.learned_table import TABLES
from peopleboy.tracker.thermal.variants import PEOPLEBOY, THESIS_OCCLUSION

PUPILS: dict[str, TrackerConfig] = {"peopleboy": PEOPLEBOY, "thesis": THESIS_OCCLUSION}
"""The trackers that put people in order, by name."""


def give_lesson(out: Path, tracker: str, seeds: int, *, triplets: bool, again: bool, ship: bool) -> Path:
    """Learn from scenarios and leave the examples and the learned table in a folder.

    Examples that an earlier lesson left there are used as they are.

    Args:
        out: the folder.
        tracker: name of the tracker to learn for, one that puts people in order.
        seeds: runs of each scenario.
        triplets: whether to try weighted triplets as well.
        again: whether to run the scenarios even if the examples are there.
        ship: whether to put the table in the place of the tracker's own.

    Returns:
        The table's path.

    Raises:
        BadInput: a tracker that has nothing to learn, a path that cannot be used, or too few examples.
    """
    if tracker not in PUPILS:
        raise BadInput(f"--tracker {tracker}: must be one that orders people: {', '.join(PUPILS)}")
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
    training = _examples(out / "training.csv", TRAINING, tracker, seeds, again=again)
    unseen = _examples(out / "unseen.csv", UNSEEN, tracker, seeds, again=again)
    check_examples(training, "training")
    check_examples(unseen, "unseen")
    with Console(stderr=True).status("learning"):
        trials = list(run_trials(training, unseen, np.random.default_rng(0), most=3 if triplets else 2))
        learned = learn(training, unseen)
    print_trials(trials)
    print_best(learned)
    path = (TABLES if ship else out) / f"{tracker}.yaml"
    learned.save(path)
    return path


def _examples(
    path: Path, scenarios: Sequence[str], tracker: str, seeds: int, *, again: bool
) -> list[PairExample]:
    """Read the examples, or run the scenarios and write them."""
    if path.exists() and not again:
        return read_pairs(path)
    examples: list[PairExample] = []
    with Console(stderr=True).status("") as status:
        for number, name in enumerate(scenarios, start=1):
            for seed in range(seeds):
                status.update(f"{name}, seed {seed} ({number} of {len(scenarios)}): {len(examples)} pairs")
                examples += collect(name, seed, PUPILS[tracker])
    write_pairs(path, examples)
    return examples
