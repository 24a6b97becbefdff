"""A run with a progress bar that tells the frame rate."""

from __future__ import annotations

from contextlib import ExitStack

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.running.run import RunOptions, run
from peopleboy.scenarios.scores.score import RunScores


def run_with_progress(scenario: Scenario, options: RunOptions) -> RunScores:
    """Run a scenario while a bar on standard error shows frames, frame rate and what the robot does.

    The bar appears with the first frame, so that a mistake found before leaves one line alone.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[mode]}"),
        TimeRemainingColumn(),
    )
    progress = Progress(*columns, console=console, refresh_per_second=5)
    task = progress.add_task(scenario.name, total=None, rate="", mode="")
    with ExitStack() as preparing, ExitStack() as running:
        preparing.enter_context(console.status("building the world; the very first time takes a minute"))

        def report(tick: Tick, frames: int) -> None:
            if tick.frame == 1:
                preparing.close()
                running.enter_context(progress)
            speed = progress.tasks[0].speed
            rate = "" if speed is None else f"{speed:.0f} frames/s"
            progress.update(task, total=frames, completed=tick.frame, rate=rate, mode=tick.mode)

        return run(scenario, options, report)
