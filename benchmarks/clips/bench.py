"""Trackers on real clips with truth: what is measured, and how it is shown."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Final

import click

from benchmarks.clips.clip import CHOSEN_BY, Clip, open_clips
from benchmarks.clips.watch import PEERS, Watched, WatchTask, make_watcher
from benchmarks.sequences import print_head, print_row
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.tracker.evaluation.evaluate import combine

OUT: Final = Path("runs/clips.json")

COLUMNS: Final[Mapping[str, str]] = {
    "HOTA": "{:.1f}",
    "IDF1": "{:.1f}",
    "MOTA": "{:.1f}",
    "CP": "{:.1f}",
    "CR": "{:.1f}",
    "one id": "{:.1f}",
    "false tracks per 1000": "{:.1f}",
    "frames per s": "{:.0f}",
}
"""How each metric is written, in the table's order."""


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

    def tasks(self, clip: Clip) -> list[WatchTask]:
        """List the work on a clip, for all trackers in turn; peers draw nothing and see it once."""
        ours = [
            WatchTask(clip, tracker, seed, self.rate_hz)
            for tracker in self.trackers
            for seed in range(self.seeds)
        ]
        return [*ours, *(WatchTask(clip, peer, 0) for peer in self.peers)]


@dataclass(frozen=True, slots=True, eq=False)
class ClipRow:
    """One tracker on one clip, all seeds together."""

    clip: Clip
    tracker: str
    watched: Sequence[Watched]

    def figures(self) -> dict[str, float]:
        """Name the metrics; NaN for those that would need everybody annotated."""
        scores = combine([one.scores for one in self.watched])
        counts, clear = scores.counts, scores.mot.clear
        everybody = {
            "HOTA": scores.mot.hota.hota,
            "IDF1": scores.mot.identity.idf1,
            "MOTA": clear.mota,
            "CP": scores.thesis.cp,
            "false tracks per 1000": 1000.0 * counts.false_tracks / counts.frames,
        }
        if self.clip.given.is_single:
            everybody = dict.fromkeys(everybody, math.nan)
        return everybody | {
            "CR": scores.thesis.cr,
            "one id": scores.mot.identity.idr,
            "frames per s": 1.0 / max(mean(one.frame_s for one in self.watched), 1e-9),
        }


def bench_clips(options: ClipsOptions) -> None:
    """Measure our trackers and peers on clips, print a table and leave its metrics as JSON.

    Raises:
        BadInput: clips or trackers cannot be used.
        TasksFailed: some could not be measured.
    """
    clips = open_clips(options.home, options.only, options.frames)
    trackers = (*options.trackers, *options.peers)
    for name in trackers:
        make_watcher(name, 0)  # refused now rather than after other trackers have run
    tasks = [task for clip in clips for task in options.tasks(clip)]
    found: dict[str, Watched] = {}
    workers = Workers(options.jobs)
    work_through(tasks, workers, "clips", lambda task, one: found.update({task.name: one}), unit="frames")
    rows = []
    for clip in clips:
        for tracker in trackers:
            mine = [task.name for task in tasks if task.clip is clip and task.tracker == tracker]
            rows.append(ClipRow(clip, tracker, [found[name] for name in mine]))
    print_rows(rows)
    write_rows(rows, options.out)


def print_rows(rows: Sequence[ClipRow]) -> None:
    """Print one Markdown table, and then which clips values were chosen by."""
    print_head("clip", ("frames", "tracker", *COLUMNS), ["---:", "---", *["---:"] * len(COLUMNS)])
    for row in rows:
        figures = row.figures()
        cells = [
            "" if math.isnan(figures[name]) else form.format(figures[name]) for name, form in COLUMNS.items()
        ]
        print_row(row.clip.name, (str(row.clip.frames), row.tracker, *cells))
    click.echo(f"\n{_split(rows)}")


def write_rows(rows: Sequence[ClipRow], path: Path) -> None:
    """Keep the metrics as JSON: clip, tracker, metric."""
    content: dict[str, dict[str, dict[str, float | None]]] = {}
    for row in rows:
        figures = {name: None if math.isnan(one) else one for name, one in row.figures().items()}
        known = {"runs": len(row.watched), "frames": row.clip.frames}
        content.setdefault(row.clip.name, {})[row.tracker] = known | figures
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _split(rows: Sequence[ClipRow]) -> str:
    clips = {row.clip.name: row.clip for row in rows}

    def listed(keep: Callable[[str], bool]) -> str:
        return ", ".join(filter(keep, clips)) or "none"

    return (
        f"- values chosen by: {listed(lambda name: name in CHOSEN_BY)}\n"
        f"- only reported: {listed(lambda name: name not in CHOSEN_BY)}\n"
        f"- one person annotated of several: {listed(lambda name: clips[name].given.is_single)}"
    )
