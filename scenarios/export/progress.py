"""A bar that grows with the frames that are rendered again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager

from rich.console import Console
from rich.progress import Progress

from peopleboy.scenarios.export.replay import Play, replay
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun


@contextmanager
def bar(title: str, runs: Sequence[FinishedRun]) -> Iterator[Play]:
    """Give a `replay` that moves a bar on standard error; the bar appears with the first frame."""
    console = Console(stderr=True)
    progress = Progress(console=console, transient=True, disable=not console.is_terminal)
    task = progress.add_task(title, total=sum(run.frames for run in runs))
    with ExitStack() as running:

        def play(run: FinishedRun) -> Iterator[Tick]:
            for tick in replay(run):
                if not progress.live.is_started:
                    running.enter_context(progress)
                yield tick
                progress.advance(task)

        yield play
