"""A scenario with many seeds, or many worlds drawn at random."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.run import RunOptions
from peopleboy.scenarios.running.run_task import RunTask, play, unfinished
from peopleboy.tracker.footage.box_kinds import BoxKind


def sweep(
    scenario: str,
    seeds: Iterable[int],
    out: Path,
    tracker: str | None,
    workers: Workers,
    behaviour: str | None = None,
    physics: str | None = None,
    boxes: BoxKind = BoxKind.TORSO,
    *,
    overwrite: bool,
) -> list[Path]:
    """Run a scenario once per seed, without recordings; a sweep that was killed goes on where it was.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run, or a complete run in its place is another one.
        TasksFailed: some runs failed.
    """
    loaded = _changed(load_scenario(scenario), behaviour, physics)
    options = [
        RunOptions(
            seed=seed,
            out=out / f"{loaded.name}-{seed}",
            tracker=tracker,
            boxes=boxes,
            record=False,
            overwrite=overwrite,
        )
        for seed in seeds
    ]
    play(unfinished([RunTask(loaded, option) for option in options]), workers, loaded.name)
    return [option.out for option in options]


def sweep_worlds(
    seeds: Iterable[int],
    out: Path,
    tracker: str | None,
    workers: Workers,
    behaviour: str | None = None,
    physics: str | None = None,
    boxes: BoxKind = BoxKind.TORSO,
    *,
    overwrite: bool,
) -> list[Path]:
    """Run worlds drawn at random, one by each seed, otherwise as `sweep`.

    Returns:
        The folders out/world_SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run, or a complete run in its place is another one.
        TasksFailed: some runs failed.
    """
    tasks = []
    for seed in seeds:
        world = _changed(random_scenario(seed), behaviour, physics)
        options = RunOptions(
            seed=seed,
            out=out / world.name,
            tracker=tracker,
            boxes=boxes,
            record=False,
            overwrite=overwrite,
        )
        tasks.append(RunTask(world, options))
    play(unfinished(tasks), workers, "random worlds")
    return [task.options.out for task in tasks]


def _changed(scenario: Scenario, behaviour: str | None, physics: str | None) -> Scenario:
    steered = scenario if behaviour is None else scenario.steered_by(behaviour)
    return steered if physics is None else steered.moved_by(physics)
