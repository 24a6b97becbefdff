"""How well people are kept in footage of unknown temperatures: `python -m benchmarks.footage`.

Scenes of the library are played, and their 16-bit pictures tracked as another person's would be: without a
scale, without the robot's motion, anywhere in the image. In a hot room clothes are colder than the walls.
`--clips DIR` measures on real clips instead, beside OpenCV's HOG with ByteTrack.
"""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Any, Final

import click
import yaml
from rich.console import Console
from rich.table import Table

from benchmarks import call
from benchmarks.real_clips import (
    CHOSEN_BY,
    PEERS,
    ClipResult,
    ClipTask,
    RealClip,
    make_clip_tracker,
    open_clips,
)
from benchmarks.sequences import print_head, print_row
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import track_footage
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.evaluation.evaluate import Scores, combine
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

    def tasks(self, clip: RealClip) -> list[ClipTask]:
        """List the work on a clip, for all trackers in turn; peers draw nothing and see it once."""
        ours = [
            ClipTask(clip, tracker, seed, self.rate_hz)
            for tracker in self.trackers
            for seed in range(self.seeds)
        ]
        return [*ours, *(ClipTask(clip, peer, 0) for peer in self.peers)]


@dataclass(frozen=True, slots=True, eq=False)
class ClipRow:
    """One tracker on one clip, all seeds together."""

    clip: RealClip
    tracker: str
    results: Sequence[ClipResult]

    def figures(self) -> dict[str, float]:
        """Name the metrics; NaN for those that would need everybody annotated."""
        scores = combine([one.scores for one in self.results])
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
            "frames per s": 1.0 / max(mean(one.frame_s for one in self.results), 1e-9),
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
        make_clip_tracker(name, 0)  # refused now rather than after other trackers have run
    tasks = [task for clip in clips for task in options.tasks(clip)]
    found: dict[str, ClipResult] = {}
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
        known = {"runs": len(row.results), "frames": row.clip.frames}
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


@click.command()
@click.option(
    "--clips", type=_FOLDER, help="Folder of clips, NAME/thermal and NAME/gt.txt, or pictures with truth."
)
@click.option(
    "--tracker",
    "trackers",
    multiple=True,
    default=(DEFAULT_TRACKER,),
    show_default=True,
    help="With --clips; may be given several times.",
)
@click.option(
    "--peer",
    "peers",
    multiple=True,
    type=click.Choice(tuple(PEERS)),
    default=tuple(PEERS),
    help="With --clips; may be given several times.  [default: all]",
)
@click.option("--only", multiple=True, help="Of --clips, those of these names.")
@click.option("--frames", type=click.IntRange(min=1), help="Of each of --clips, the first so many.")
@click.option(
    "--rate-hz", type=click.FloatRange(min=0.1), help="Of --clips.  [default: as `peopleboy track`]"
)
@click.option(
    "--seeds", type=click.IntRange(min=1), default=1, show_default=True, help="Of trackers, with --clips."
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes, with --clips."
)
def main(clips: Path | None, seeds: int, **how: Any) -> None:
    """Print how people are kept in scenes of the library, or how trackers do on clips.

    Figures are percent. Those of --clips are left in runs/clips.json, too.
    """
    if clips is not None:
        bench_clips(ClipsOptions(home=clips, seeds=seeds, **how))
        return
    with tempfile.TemporaryDirectory() as folder:
        _show_rooms(Path(folder))


def _show_rooms(folder: Path) -> None:
    table = Table("scenes in", "CP", "CR", "AA", "IDF1", "HOTA", "false tracks", box=None)
    for room, temperatures in ROOMS.items():
        scores = combine(list(_scores_of(temperatures, folder / room.replace(" ", "-"))))
        figures = (
            *(scores.thesis.cp, scores.thesis.cr, scores.thesis.aa),
            *(scores.mot.identity.idf1, scores.mot.hota.hota),
        )
        table.add_row(room, *(f"{figure:.1f}" for figure in figures), str(scores.counts.false_tracks))
    Console().print(table)


def _scores_of(temperatures: Mapping[str, float], folder: Path) -> Iterator[Scores]:
    for scene in SCENES:
        home = folder / scene
        _play(scene, temperatures, home)
        options = TrackOptions(
            footage=home / "thermal16", truth=home / "truth" / "gt.txt", out=folder / f"{scene}-tracked"
        )
        yield _tracked(options)


def _play(scene: str, temperatures: Mapping[str, float], home: Path) -> None:
    """Play a scene of the library in a room of these temperatures, and keep its pictures and truth."""
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
        raise click.BadParameter(f"{options.footage}: there is no truth beside the pictures")
    return scores


if __name__ == "__main__":
    call(main, "benchmarks.footage")
