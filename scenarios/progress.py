"""A run with a progress bar that tells the frame rate."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from scenarios.loop import Tick
from scenarios.run import RunOptions, run
from scenarios.scenario import Scenario
from scenarios.score import RunScores


def run_with_progress(scenario: Scenario, options: RunOptions) -> RunScores:
    """Run a scenario while a bar on standard error shows frames, frame rate and what the robot does."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[mode]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), refresh_per_second=5) as progress:
        task = progress.add_task(scenario.name, total=None, rate="", mode="preparing")

        def report(tick: Tick, frames: int) -> None:
            speed = progress.tasks[0].speed
            rate = "" if speed is None else f"{speed:.0f} frames/s"
            progress.update(task, total=frames, completed=tick.frame, rate=rate, mode=tick.mode)

        return run(scenario, options, report)
