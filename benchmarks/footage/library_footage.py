"""Tracking of scenes of the library whose images are taken for foreign footage."""

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import click
import yaml

from benchmarks.compare import percents, print_table
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario_file import to_data
from peopleboy.scenarios.footage.options import TrackOptions
from peopleboy.scenarios.footage.track_footage import track_footage
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.evaluation.evaluate import Scores, combine

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


def show_rooms() -> None:
    """Print metrics of the default tracker in both rooms."""
    shown = ("CP", "CR", "AA", "IDF1", "HOTA")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for room, temperatures in ROOMS.items():
            scores = combine(list(_scores_of(temperatures, Path(folder) / room.replace(" ", "-"))))
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
