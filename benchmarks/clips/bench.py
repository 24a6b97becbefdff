"""Trackers on clips: who watches what, and what is shown of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from benchmarks.clips.clip import Clip, open_clips
from benchmarks.clips.show import ClipRow, print_rows, write_rows
from benchmarks.clips.watch import PEERS, Watched, WatchTask, make_watcher
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.workers import Workers

OUT: Final = Path("runs/clips.json")


@dataclass(frozen=True, slots=True, kw_only=True)
class ClipsOptions:
    """What is to be measured.

    Attributes:
        home: folder of clips.
        trackers: names of ours.
        peers: names of peers.
        only: names of clips; none for all.
        frames: how many of each clip; None for all.
        seeds: how many of each of our trackers, from 0 on.
        rate_hz: pictures a second; None for what a folder is taken to have.
        jobs: processes at the same time.
        out: JSON file to leave.
    """

    home: Path
    trackers: Sequence[str]
    peers: Sequence[str] = tuple(PEERS)
    only: Sequence[str] = ()
    frames: int | None = None
    seeds: int = 1
    rate_hz: float | None = None
    jobs: int = 1
    out: Path = OUT


def bench_clips(options: ClipsOptions) -> None:
    """Measure our trackers and peers on clips, print a table and leave its figures as JSON.

    Raises:
        BadInput: clips or trackers cannot be used.
        TasksFailed: some could not be measured.
    """
    clips = open_clips(options.home, options.only, options.frames)
    for name in (*options.trackers, *options.peers):
        make_watcher(name, 0)
    tasks = [task for clip in clips for task in _tasks(clip, options)]
    found: dict[str, Watched] = {}
    work_through(
        tasks, Workers(options.jobs), "clips", lambda task, one: found.update({task.name: one}), unit="frames"
    )
    rows = [
        _row(clip, tracker, tasks, found) for clip in clips for tracker in (*options.trackers, *options.peers)
    ]
    print_rows(rows)
    write_rows(rows, options.out)


def _tasks(clip: Clip, options: ClipsOptions) -> list[WatchTask]:
    """Clip by clip, so that all trackers see it in turn; peers draw nothing and see it once."""
    ours = [
        WatchTask(clip, tracker, seed, options.rate_hz)
        for tracker in options.trackers
        for seed in range(options.seeds)
    ]
    return [*ours, *(WatchTask(clip, peer, 0) for peer in options.peers)]


def _row(clip: Clip, tracker: str, tasks: Sequence[WatchTask], found: dict[str, Watched]) -> ClipRow:
    mine = [task.name for task in tasks if task.clip is clip and task.tracker == tracker]
    return ClipRow(clip, tracker, [found[name] for name in mine])
