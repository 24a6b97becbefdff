"""Comparison of trackers and peers on clips: a table, changes by alterations, and a JSON file."""

import json
import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import mean
from typing import Any, Final

import click

from benchmarks.compare import METRICS, compare, false_per_1000, print_head, print_row, print_table, rows_of
from benchmarks.footage.altered_clips import alter, altered_name
from benchmarks.footage.real_clips import (
    CHOSEN_BY,
    ClipResult,
    ClipTask,
    RealClip,
    make_clip_tracker,
    open_clips,
)
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.tracker.evaluation.average_precision import average_precision
from peopleboy.tracker.evaluation.evaluate import combine
from peopleboy.tracker.evaluation.sequence import TrackBoxes

OUT: Final = Path("runs/clips.json")
COLUMNS: Final[Mapping[str, str]] = {
    "HOTA": "{:.1f}",
    "IDF1": "{:.1f}",
    "MOTA": "{:.1f}",
    "CP": "{:.1f}",
    "CR": "{:.1f}",
    "one id": "{:.1f}",
    "AP": "{:.1f}",
    "AP50": "{:.1f}",
    "AP50 small": "{:.1f}",
    "AP50 medium": "{:.1f}",
    "AP50 large": "{:.1f}",
    "false tracks per 1000": "{:.1f}",
    "frames per s": "{:.0f}",
}
"""Format of each metric, in the order of the table."""

HEIGHTS_PX: Final = {"small": (0.0, 48.0), "medium": (48.0, 96.0), "large": (96.0, math.inf)}
"""Heights of people by size."""


def clip_metrics(clip: RealClip, results: Sequence[ClipResult]) -> dict[str, float]:
    """Return the metrics of a tracker on a clip; NaN for those that need all people annotated."""
    scores = combine([one.scores for one in results])
    found = {name: METRICS[name](scores) for name in ("HOTA", "IDF1", "MOTA", "CP")}
    found["false tracks per 1000"] = false_per_1000(scores)
    found |= detection_metrics(clip, results[0].detections)
    if clip.given.is_single:
        found = dict.fromkeys(found, math.nan)
    found |= {name: METRICS[name](scores) for name in ("CR", "one id")}
    return found | {"frames per s": 1.0 / max(mean(one.frame_s for one in results), 1e-9)}


def detection_metrics(clip: RealClip, detections: TrackBoxes) -> dict[str, float]:
    """Return the average precisions of detections [%]; NaN without any people or detections."""
    if not len(detections):
        return dict.fromkeys(("AP", "AP50", *(f"AP50 {size}" for size in HEIGHTS_PX)), math.nan)
    every = average_precision(clip.given.truth, detections)
    sizes = {
        f"AP50 {size}": average_precision(clip.given.truth, detections, heights).ap50
        for size, heights in HEIGHTS_PX.items()
    }
    return {"AP": every.ap, "AP50": every.ap50, **sizes}


def compare_clips(
    home: Path,
    *,
    trackers: Sequence[str],
    peers: Sequence[str],
    only: Sequence[str],
    frames: int | None,
    rate_hz: float | None,
    seeds: int,
    jobs: int,
    alterations: Sequence[str] = (),
    real_training: bool = False,
) -> None:
    """Evaluate trackers and peers on clips, print a table, and write its metrics as JSON.

    Args:
        home: folder of clips.
        trackers: names of PeopleBoy's trackers.
        peers: names of peers, which are deterministic and run once per clip.
        only: names of clips; empty for all.
        frames: number of frames per clip; None for all.
        rate_hz: frame rate; None for the default of `peopleboy track`.
        seeds: number of seeds per tracker, from 0 on.
        jobs: number of processes.
        alterations: names of `ALTERATIONS`; each clip is evaluated altered by each of them, too.
        real_training: whether to evaluate networks that are trained on the other clips, too.

    Raises:
        BadInput: clips or trackers cannot be used.
        TasksFailed: some evaluations failed.
    """
    given = open_clips(home, only, frames)
    for name in (*trackers, *peers):
        make_clip_tracker(name, 0)  # fails now rather than after other trackers have run
    with tempfile.TemporaryDirectory() as folder:
        altered = [alter(clip, name, Path(folder)) for clip in given for name in alterations]
        clips = {clip.name: clip for clip in (*given, *altered)}
        tasks = {}
        for name, clip in clips.items():
            ours = {
                (name, one): [ClipTask(clip, one, seed, rate_hz) for seed in range(seeds)] for one in trackers
            }
            tasks |= ours | {(name, peer): [ClipTask(clip, peer, 0)] for peer in peers}
        if real_training:
            from benchmarks.footage.real_training import NAME, real_training_tasks  # needs JAX

            more = real_training_tasks(given, rate_hz, Path(folder), Workers(jobs))
            tasks |= {(task.clip.name, NAME): [task] for task in more}
        found = compare(tasks, Workers(jobs), "clips", unit="frames")
    metrics = {
        (name, tracker): clip_metrics(clips[name], results) for (name, tracker), results in found.items()
    }
    _print_clips(clips, metrics)
    names = [clip.name for clip in given]
    changes = {
        tracker: {one: change_of_hota(metrics, tracker, names, one) for one in alterations}
        for tracker in (*trackers, *peers)
    }
    if alterations:
        click.echo()
        print_table(["change of HOTA", *alterations], rows_of(changes, dict.fromkeys(alterations, "{:+.1f}")))
    click.echo(f"\n{_split({clip.name: clip for clip in given})}")
    runs = {key: len(results) for key, results in found.items()}
    _write_metrics(
        clips, metrics, runs, {tracker: {"changes": of_all} for tracker, of_all in changes.items()}
    )


def change_of_hota(
    metrics: Mapping[tuple[str, str], Mapping[str, float]],
    tracker: str,
    clips: Sequence[str],
    alteration: str,
) -> float | None:
    """Return by how much an alteration of the pictures changes the mean HOTA of clips [%].

    Args:
        metrics: by names of clip and tracker; altered clips are named as `alter` says.
        tracker: name of the tracker.
        clips: names of the clips; those whose HOTA is NaN are left out.
        alteration: its name.
    """
    changed = [
        metrics[altered_name(name, alteration), tracker]["HOTA"] - metrics[name, tracker]["HOTA"]
        for name in clips
    ]
    known = [one for one in changed if not math.isnan(one)]
    return mean(known) if known else None


def _print_clips(
    clips: Mapping[str, RealClip], metrics: Mapping[tuple[str, str], Mapping[str, float]]
) -> None:
    print_head("clip", ("frames", "tracker", *COLUMNS), ["---:", "---", *["---:"] * len(COLUMNS)])
    for (name, tracker), found in metrics.items():
        cells = ["" if math.isnan(found[one]) else form.format(found[one]) for one, form in COLUMNS.items()]
        print_row(name, (str(clips[name].frames), tracker, *cells))


def _write_metrics(
    clips: Mapping[str, RealClip],
    metrics: Mapping[tuple[str, str], Mapping[str, float]],
    runs: Mapping[tuple[str, str], int],
    content: dict[str, dict[str, Any]],
) -> None:
    """Write metrics as JSON, by clip and tracker."""
    for (name, tracker), found in metrics.items():
        known = {one: None if math.isnan(value) else value for one, value in found.items()}
        counts = {"runs": runs[name, tracker], "frames": clips[name].frames}
        content.setdefault(name, {})[tracker] = counts | known
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _split(clips: Mapping[str, RealClip]) -> str:
    """List the clips that were used for tuning, and the others."""

    def listed(keep: Callable[[str], bool]) -> str:
        return ", ".join(filter(keep, clips)) or "none"

    return (
        f"- used for tuning: {listed(lambda name: name in CHOSEN_BY)}\n"
        f"- not used for tuning: {listed(lambda name: name not in CHOSEN_BY)}\n"
        f"- only one of several people annotated: {listed(lambda name: clips[name].given.is_single)}"
    )
