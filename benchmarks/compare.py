"""Common parts of all comparisons: recorded sequences, trackers on them, their metrics, and tables."""

import json
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter
from pathlib import Path
from typing import Any, Final, TypeVar

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.running.engine.task import Task, Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.sim.truth.truth import Truth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import boxed_whole
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.track import Track, confirmed
from peopleboy.tracker.trackers import CONTOUR_TRACKER, make_tracker

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


def rows_of(
    found: Mapping[str, Mapping[str, float | None]], columns: Mapping[str, str]
) -> list[tuple[str, ...]]:
    """Return the rows of a table of results, whose columns are given with their formats."""
    return [
        (name, *("" if one[key] is None else form.format(one[key]) for key, form in columns.items()))
        for name, one in found.items()
    ]


def update_results(path: Path, found: Mapping[str, Any]) -> None:
    """Write results to a JSON file; those of other keys stay."""
    kept = json.loads(path.read_text("utf-8")) if path.is_file() else {}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(kept | dict(found), indent=1) + "\n", encoding="utf-8")


# CPU times of contestants that take turns, as medians and ratios.

Work = Callable[[], object]


def timed_ms(work: Callable[[], Result]) -> tuple[float, Result]:
    """Return the CPU time [ms] of a call, and its result."""
    start = time.process_time()
    result = work()
    return 1000.0 * (time.process_time() - start), result


def spent_ms(work: Work) -> float:
    """Return the CPU time [ms] of a call."""
    return timed_ms(work)[0]


def median_ms(works: Iterable[Work]) -> float:
    """Return the median CPU time [ms] of several calls, after one call for warm-up."""
    listed = list(works)
    listed[0]()
    return float(np.median([spent_ms(work) for work in listed]))


@dataclass(slots=True)
class Turns:
    """Times or rates of contestants that take turns, by name.

    The speed of a machine varies with its other load. Contestants that take turns within a second run under
    the same load, so the median of their ratios is more stable than the ratio of their medians.
    """

    values: dict[str, list[float]] = field(default_factory=dict)

    def add(self, turn: Mapping[str, float]) -> None:
        """Add the values of a turn; NaN for a contestant that was left out."""
        for name, value in turn.items():
            self.values.setdefault(name, []).append(value)

    def measure(self, works: Mapping[str, Work]) -> None:
        """Time each contestant once [ms], in this order."""
        self.add({name: spent_ms(work) for name, work in works.items()})

    def median(self, name: str) -> float:
        """Return the median of a contestant."""
        return float(np.nanmedian(self.values[name]))

    def least(self, name: str) -> float:
        """Return the least value of a contestant, which is least affected by other load."""
        return min(self.values[name])

    def ratio(self, name: str, other: str) -> float:
        """Return the ratio of one contestant's value to another's, median over the turns."""
        return float(np.median(np.divide(self.values[name], self.values[other])))


# Recorded sequences: frames, ground truth, and tracks in the form for scoring.

TruthRow = tuple[int, int, Sequence[float], bool, float]


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """A recorded sequence.

    Attributes:
        frames: frames for a tracker.
        truth: boxes of all people.
        boxes_whole: whether boxes enclose whole people.
    """

    frames: tuple[Frame, ...]
    truth: TrueBoxes
    boxes_whole: bool = False

    def uncalibrated(self) -> "Recording":
        """Return the recording without camera calibrations."""
        return replace(self, frames=tuple(replace(frame, calibrations={}) for frame in self.frames))

    def score(self, tracks: Iterable[Sequence[Track]], min_visible: float = 0.0) -> Scores:
        """Score the tracks of each frame; only people with more than a visible share count."""
        if self.boxes_whole:
            tracks = (boxed_whole(each, frame) for each, frame in zip(tracks, self.frames, strict=True))
        found = confirmed_boxes(tracks)
        return evaluate(self.truth, found, frames=len(self.frames), min_visible=min_visible)


def record(scenario: str | Scenario, seed: int) -> Recording:
    """Run a scenario in the closed loop with the contour tracker, and record its frames."""
    loaded = load_scenario(scenario) if isinstance(scenario, str) else scenario
    config = loaded.world(seed)
    frames, rows, before = [], [], None
    with SimulatedWorld(config) as world:
        count = round(loaded.duration_s * config.control_hz)
        tracker = make_tracker(CONTOUR_TRACKER, seed)
        for tick in closed_loop(world, tracker, loaded.make_behaviour(), count):
            frames.append(Frame.from_observation(tick.observation, before))
            before = tick.observation.odometry
            rows += truth_rows(tick.frame, tick.truth)
    return Recording(tuple(frames), TrueBoxes.from_rows(rows))


def truth_rows(frame: int, truth: Truth) -> list[TruthRow]:
    """Return frame, id, box, whether it counts, and visible share of all people with a box."""
    return [
        (frame, person.id, person.box, person.is_counted, person.visible_fraction)
        for person in truth.people
        if person.box is not None
    ]


def confirmed_boxes(frames: Iterable[Iterable[Track]]) -> TrackBoxes:
    """Yield the boxes of confirmed tracks in the thermal image by frame number, from 1 on."""
    return TrackBoxes.from_rows(
        (number, track.id, box, track.confidence)
        for number, tracks in enumerate(frames, start=1)
        for track, box in confirmed(tracks, THERMAL)
    )


def print_row(name: str, cells: Sequence[str]) -> None:
    """Print one row of a Markdown table as soon as it is known."""
    click.echo(f"| {' | '.join((name, *cells))} |")


def print_head(name: str, columns: Sequence[str], ruler: Sequence[str] | None = None) -> None:
    """Print the header of a Markdown table with right-aligned numbers."""
    print_row(name, columns)
    print_row("---", ruler or ["---:"] * len(columns))
