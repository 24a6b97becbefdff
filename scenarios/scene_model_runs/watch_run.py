"""Let a scene model watch a finished run, and leave what it tells beside it."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.recording.scene_layer import SceneRecording
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.scene_model_runs.bodies import Bodies
from peopleboy.scenarios.scene_model_runs.run_frames import check_frames, run_frames
from peopleboy.scenarios.scene_model_runs.scene_files import (
    BACKGROUND,
    LINES,
    MAP,
    RECORDING,
    scene_line,
    write_background,
    write_map,
)
from peopleboy.scenarios.scene_model_runs.tell import sentence
from peopleboy.scenarios.scene_model_runs.thing_names import thing_names
from peopleboy.scenarios.scene_model_runs.true_events import KINDS, TrueEvent, WhoIsWho
from peopleboy.tracker.frame import DEPTH
from peopleboy.tracker.scene_model.scene import Change, Happening
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel

FOLDER = "scene"
"""Where it lies in the folder of a run."""

Spot = tuple[float, float]
_PEOPLE = ("frame", "name", "x_m", "y_m", "whole_px", "hidden_by", "left_px", "id")


@dataclass(frozen=True, slots=True, kw_only=True)
class WatchOptions:
    """How to watch.

    Attributes:
        has_heat: whether the thermal image tells people from things.
        record: whether to write a recording.
    """

    has_heat: bool = True
    record: bool = True


def watch_run(
    run: FinishedRun, out: Path, options: WatchOptions, report: Callable[[int, int], None]
) -> list[str]:
    """Watch a run from start to end and write a folder, which replaces an earlier one.

    Args:
        run: with images.
        out: the folder.
        options: how.
        report: called after every frame with its number and how many there are.

    Returns:
        What happened, a sentence each, in the order of time.

    Raises:
        BadInput: the run has no images of a depth camera, or they are spoilt.
    """
    check_frames(run)
    with atomic(out) as folder:
        folder.mkdir(parents=True)
        return _watched(run, folder, options, report)


def _watched(
    run: FinishedRun, folder: Path, options: WatchOptions, report: Callable[[int, int], None]
) -> list[str]:
    files = run.files(people=_PEOPLE)
    start = files.robot.slice(0, 1).to_pylist()[0]
    first = Pose2(start["x_m"], start["y_m"], start["heading_rad"])
    people = {k: [(row["name"], first.to_local((row["x_m"], row["y_m"]))) for row in rows]
              for k, rows in files.people_by_frame().items()}  # fmt: skip
    model = SceneModel(SceneConfig(people=PeopleMaskConfig(has_heat=options.has_heat)))
    who, bodies, happenings = WhoIsWho(), Bodies(), list[Happening]()
    with ExitStack() as stack:
        lines = stack.enter_context((folder / LINES).open("w", encoding="utf-8"))
        layer = None
        if options.record:
            layer = stack.enter_context(SceneRecording(folder / RECORDING, _title(run), first))
        for frame in run_frames(run):
            number = round(frame.time_s * run.rate_hz) + 1
            scene = model.update(frame)
            lines.write(scene_line(scene))
            who.look([(one.id, one.place_m) for one in scene.persons], people.get(number, []))
            bodies.look(frame.time_s, [one.place_m for one in scene.persons])
            happenings += [one for one in scene.happenings if not bodies.are_at(one)]
            if layer is not None:
                depth = (frame.depth(DEPTH) / 1000.0).astype(np.float32)
                layer.log(number, scene, depth, model.geometry, model.pose)
            report(number, run.frames)
        happenings += [one for one in model.finish() if not bodies.are_at(one)]
        write_map(model.static_map(), folder / MAP)
        write_background(scene.background_m, folder / BACKGROUND)
        told = _known(happenings, who, true_events(run), first)
        if layer is not None:
            layer.log_map(model.static_map())
            layer.log_events([(happening.known_s, line) for happening, line in told])
    return [line for _, line in sorted(told, key=lambda one: one[0].time_s)]


def true_events(run: FinishedRun) -> list[TrueEvent]:
    """Read what truly happened to things, from the log of a run and its table of things."""
    lines = [line for line in run.events if line.kind in KINDS]
    path = run.folder / "truth" / "things.parquet"
    if not lines or not path.is_file():
        return []
    table = pq.read_table(path, columns=["frame", "name", "x_m", "y_m"]).to_pylist()
    places: dict[str, list[tuple[int, Spot]]] = defaultdict(list)
    for row in table:
        places[row["name"]].append((row["frame"], (row["x_m"], row["y_m"])))
    return [TrueEvent.of(one, one.who, one.other, _next(places[one.who], one.frame)) for one in lines]


def _next(places: Sequence[tuple[int, Spot]], frame: int) -> Spot:
    """Give the place of a frame, or of the next one with an image; of the last one when there is none."""
    at = bisect_left(places, frame, key=lambda one: one[0])
    return places[min(at, len(places) - 1)][1]


def _known(
    happenings: Sequence[Happening], who: WhoIsWho, events: Sequence[TrueEvent], first: Pose2
) -> list[tuple[Happening, str]]:
    """Put what happened into words, with the names of the things that it truly happened to."""
    happenings = _without_halves(happenings)
    names = thing_names(happenings, events, first)
    return [(one, sentence(one, who.name, names.get(one.object))) for one in happenings]


def _without_halves(happenings: Sequence[Happening]) -> list[Happening]:
    """Leave out what was told to vanish or appear until it was clear that it was moved."""
    moved = [one for one in happenings if one.change is Change.MOVED]
    ends = {end for one in moved for end in (one.from_m, one.to_m)}
    others = [one for one in happenings if one.change is not Change.MOVED]
    return [*moved, *(one for one in others if (one.from_m or one.to_m) not in ends)]


def _title(run: FinishedRun) -> str:
    return f"{run.about.scenario}, seed {run.about.seed}, tracker {run.about.tracker}"
