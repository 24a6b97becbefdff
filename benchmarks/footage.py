"""How well people are kept in footage of unknown temperatures: `python -m benchmarks.footage`.

Scenes of the library are played, and their 16-bit pictures tracked as somebody else's would be: without a
scale, without the robot's motion, anywhere in the image. In a hot room clothes are colder than the walls.
`--clips DIR` measures on real clips instead, beside OpenCV's HOG with ByteTrack.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import click
import yaml
from rich.console import Console
from rich.table import Table

from benchmarks import call
from benchmarks.clips.bench import ClipsOptions, bench_clips
from benchmarks.clips.watch import PEERS
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import track_footage
from peopleboy.scenarios.running.run import RunOptions, run
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
