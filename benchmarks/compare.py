"""What all comparisons share: contestants on sequences, the metrics of each, and tables of them."""

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
"""Metrics [%] by the name that tables have for them."""


def percents(scores: Scores, *names: str) -> list[str]:
    """Return some of `METRICS` as tables write them."""
    return [f"{METRICS[name](scores):.1f}" for name in names]


def false_per_1000(scores: Scores) -> float:
    """Return false tracks per 1000 frames."""
    return 1000.0 * scores.counts.false_tracks / scores.counts.frames


def compare(
    tasks: Mapping[Key, Sequence[Task[Result]]], workers: Workers, title: str, unit: str | None = None
) -> dict[Key, list[Result]]:
    """Do the tasks of all contestants, and return each one's results in the order of its tasks.

    Args:
        tasks: by contestant; their names differ.
        workers: who does them.
        title: stands before the progress bar.
        unit: in which the tasks' sizes are counted, if the bar shows how many a second.

    Raises:
        BadInput: every task was refused as bad input.
        TasksFailed: some failed, after all others were done.
    """
    found: dict[str, Result] = {}
    every = [task for several in tasks.values() for task in several]
    work_through(every, workers, title, lambda task, one: found.update({task.name: one}), unit=unit)
    return {key: [found[task.name] for task in several] for key, several in tasks.items()}


def print_table(columns: Sequence[str], rows: Iterable[Sequence[str]], width: int | None = None) -> None:
    """Print rows under the names of their columns."""
    table = Table(*columns, box=None)
    for row in rows:
        table.add_row(*row)
    Console(width=width).print(table)
