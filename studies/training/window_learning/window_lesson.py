"""The whole lesson: examples, machines, and how good these are in places that nobody learned from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

from rich.console import Console

from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.window_learning.teach_windows import judgement, teach_windows
from peopleboy.studies.training.window_learning.window_examples import WindowExamples
from peopleboy.studies.training.window_learning.window_task import WindowTask
from peopleboy.tracker.rgbd.verification.window_model import WEIGHTS, file_name

FIRST_SEED: Final = 100
"""Of scenes to learn from; those below are for judging."""

TESTS: Final[Mapping[str, int]] = {
    "": 30,
    "crossing_2_moving": 2,
    "crowd_8_moving": 1,
    "fast_turn": 2,
    "hall_visits": 1,
}
"""How many scenes judge: drawn at random, and of the library, whose places nobody learned from."""


def give_window_lesson(out: Path, workers: Workers, *, scenes: int, ship: bool) -> tuple[Path, ...]:
    """Learn what people look like, and leave examples and machines in a folder.

    Examples that are there are used.

    Args:
        out: the folder.
        workers: who plays scenes.
        scenes: how many to learn from.
        ship: whether to put the machines in the place of the tracker's own.

    Returns:
        The machines' files: of colour alone, and with depth.

    Raises:
        BadInput: a path that cannot be used, scikit-learn is missing, or too few examples.
        TasksFailed: some scenes failed, after all others were done.
    """
    folder = out / "examples"
    with writing_to(out):
        folder.mkdir(parents=True, exist_ok=True)
    task = partial(WindowTask, folder=str(folder))
    tests = [
        task(scenario=name, seed=k, has_jitter=False) for name, count in TESTS.items() for k in range(count)
    ]
    tasks = [task(seed=seed) for seed in range(FIRST_SEED, FIRST_SEED + scenes)]
    work_through([one for one in (*tests, *tasks) if not one.path.is_file()], workers, "examples")
    learned, others = _load(tasks), _load(tests)
    source = f"{scenes} scenes drawn at random, seeds from {FIRST_SEED}"
    goal = WEIGHTS if ship else out
    with writing_to(goal):
        goal.mkdir(parents=True, exist_ok=True)
    return tuple(_taught(learned, others, goal, source, sees_depth=sees) for sees in (False, True))


def _taught(
    learned: WindowExamples, others: WindowExamples, goal: Path, source: str, *, sees_depth: bool
) -> Path:
    model = teach_windows(learned, sees_depth=sees_depth)
    path = goal / file_name(sees_depth=sees_depth)
    words = judgement(model, others)
    for kind, said in words.items():
        Console(stderr=True).print(f"{path.stem}, {kind}, other scenes: {said}", highlight=False)
    about = {f"{kind}, on other scenes": said for kind, said in words.items()}
    replace(model, about=about | {"trained on": source}).save(path)
    return path


def _load(tasks: Sequence[WindowTask]) -> WindowExamples:
    return WindowExamples.joined([WindowExamples.load(task.path) for task in tasks])
