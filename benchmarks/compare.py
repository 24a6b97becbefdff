"""Common parts of all comparisons: trackers on sequences, their metrics, and tables."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import attrgetter
from typing import Final, TypeVar

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.running.engine.task import Task, Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.tracker.evaluation.evaluate import Scores

Key = TypeVar("Key")
Result = TypeVar("Result")

METRICS: Final[Mapping[str, Callable[[Scores], float]]] = {
    "CP": attrgetter("thesis.cp"),
    "CR": attrgetter("thesis.cr"),
    "AA": attrgetter("thesis.aa"),
    "HOTA": attrgetter("mot.hota.hota"),
    "IDF1": attrgetter("mot.identity.idf1"),
    "MOTA": attrgetter("mot.clear.mota"),
    "one id": attrgetter("mot.identity.idr"),
}
"""Metrics [%] by their column title in tables."""


def percents(scores: Scores, *names: str) -> list[str]:
    """Return some of `METRICS`, formatted for a table."""
    return [f"{METRICS[name](scores):.1f}" for name in names]


def false_per_1000(scores: Scores) -> float:
    """Return false tracks per 1000 frames."""
    return 1000.0 * scores.counts.false_tracks / scores.counts.frames


def compare(
    tasks: Mapping[Key, Sequence[Task[Result]]], workers: Workers, title: str, unit: str | None = None
) -> dict[Key, list[Result]]:
    """Run the tasks of all trackers, and return the results of each in the order of its tasks.

    Args:
        tasks: tasks by tracker, with unique names.
        workers: pool that runs the tasks.
        title: label of the progress bar.
        unit: unit of the tasks' sizes, if the progress bar shows a rate.

    Raises:
        BadInput: all tasks failed with bad input.
        TasksFailed: some failed, after all others were done.
    """
    found: dict[str, Result] = {}
    every = [task for several in tasks.values() for task in several]
    work_through(every, workers, title, lambda task, one: found.update({task.name: one}), unit=unit)
    return {key: [found[task.name] for task in several] for key, several in tasks.items()}


def print_table(columns: Sequence[str], rows: Iterable[Sequence[str]], width: int | None = None) -> None:
    """Print rows under column titles."""
    table = Table(*columns, box=None)
    for row in rows:
        table.add_row(*row)
    Console(width=width).print(table)
