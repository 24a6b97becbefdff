"""Tracking quality in footage of unknown temperatures: `python -m benchmarks.footage`.

Scenes of the library are rendered, and their 16-bit images are tracked like foreign footage: without a
temperature scale and without the robot's motion. In a hot room clothes are colder than the walls.
`--clips DIR` evaluates on real clips instead, compared with OpenCV's HOG with ByteTrack.
"""

import json
import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean
from typing import Any, Final

import click
import yaml

from benchmarks import call
from benchmarks.altered_clips import ALTERATIONS, alter, altered_name
from benchmarks.compare import (
    METRICS,
    compare,
    false_per_1000,
    percents,
    print_head,
    print_row,
    print_table,
    rows_of,
)
from benchmarks.real_clips import (
    CHOSEN_BY,
    PEERS,
    ClipResult,
    ClipTask,
    RealClip,
    make_clip_tracker,
    open_clips,
)
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import track_footage
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.evaluation.average_precision import average_precision
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.trackers import DEFAULT_TRACKER

SCENES: Final = (
    "crossing_2",
    "crossing_2_moving",
    "pass_behind",
    "sitting",
    "stop_and_talk",
    "group_abreast",
    "empty_room",
)
ROOMS: Final[Mapping[str, Mapping[str, float]]] = {
    "a room of 21 degC": {},
    "a room of 31 degC": {"floor_c": 30.0, "walls_c": 31.0, "ceiling_c": 32.0, "surroundings_c": 31.0},
}
DURATION_S: Final = 12.0
SEED: Final = 1
_FOLDER: Final = click.Path(exists=True, file_okay=False, path_type=Path)

OUT: Final = Path("runs/clips.json")
_NONE: Final = "none"
"""Name of no peer."""
_ALL: Final = "all"
"""Name of all alterations."""

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


def bench_clips(
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
    _keep(clips, metrics, runs, {tracker: {"changes": of_all} for tracker, of_all in changes.items()})


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


def _keep(
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


@click.command()
@click.option(
    "--clips", type=_FOLDER, help="Folder of clips, NAME/thermal and NAME/gt.txt, or images with truth."
)
@click.option(
    "--tracker",
    "trackers",
    multiple=True,
    default=(DEFAULT_TRACKER,),
    show_default=True,
    help="Tracker to evaluate on --clips; may be repeated.",
)
@click.option(
    "--peer",
    "peers",
    multiple=True,
    type=click.Choice((*PEERS, _NONE)),
    default=tuple(PEERS),
    help="Peer to evaluate on --clips; may be repeated.  [default: all]",
)
@click.option("--only", multiple=True, help="Name of a clip to use; may be repeated.")
@click.option("--frames", type=click.IntRange(min=1), help="Number of frames to use of each clip.")
@click.option(
    "--rate-hz", type=click.FloatRange(min=0.1), help="Frame rate.  [default: as `peopleboy track`]"
)
@click.option(
    "--altered",
    "alterations",
    multiple=True,
    type=click.Choice((*ALTERATIONS, _ALL)),
    help="Also evaluate on --clips altered like this, for robustness; may be repeated.",
)
@click.option("--seeds", type=click.IntRange(min=1), default=1, show_default=True, help="Seeds per tracker.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Number of processes.")
def main(clips: Path | None, peers: Sequence[str], alterations: Sequence[str], **how: Any) -> None:
    """Print metrics of the default tracker in library scenes, or of trackers and peers on clips.

    Metrics are in percent. AP and AP50 are average precisions of the detections, by COCO's rules; people are
    small below 48 px, and large from 96 px on. Those of --clips are also written to runs/clips.json.
    """
    if clips is not None:
        bench_clips(
            clips,
            peers=[peer for peer in peers if peer != _NONE],
            alterations=tuple(ALTERATIONS) if _ALL in alterations else alterations,
            **how,
        )
        return
    with tempfile.TemporaryDirectory() as folder:
        _show_rooms(Path(folder))


def _show_rooms(folder: Path) -> None:
    shown = ("CP", "CR", "AA", "IDF1", "HOTA")
    rows = []
    for room, temperatures in ROOMS.items():
        scores = combine(list(_scores_of(temperatures, folder / room.replace(" ", "-"))))
        rows.append([room, *percents(scores, *shown), str(scores.counts.false_tracks)])
    print_table(["scenes in", *shown, "false tracks"], rows)


def _scores_of(temperatures: Mapping[str, float], folder: Path) -> Iterator[Scores]:
    for scene in SCENES:
        home = folder / scene
        _play(scene, temperatures, home)
        options = TrackOptions(
            footage=home / "thermal16", truth=home / "truth" / "gt.txt", out=folder / f"{scene}-tracked"
        )
        yield _tracked(options)


def _play(scene: str, temperatures: Mapping[str, float], home: Path) -> None:
    """Run a scene of the library at these room temperatures, and keep its images and ground truth."""
    changed: dict[str, Any] = {
        "name": scene,
        "description": f"{scene}, shortened",
        "like": scene,
        "duration_s": DURATION_S,
    }
    if temperatures:
        place = to_data(load_scenario(scene).spec)["place"]
        changed["place"] = place | {"temperatures": dict(temperatures)}
    path = home.with_suffix(".yaml")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump(changed), encoding="utf-8")
    options = RunOptions(seed=SEED, out=home, frames=True, tracker="truth", record=False)
    run(load_scenario(path), options, lambda *_: None)


def _tracked(options: TrackOptions) -> Scores:
    scores = track_footage(options, lambda *_: None).scores
    if scores is None:
        raise click.BadParameter(f"{options.footage}: no ground truth next to the images")
    return scores


if __name__ == "__main__":
    call(main, "benchmarks.footage")
