"""Run a scene model on the images of a finished run, and write its output."""

import json
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow.parquet as pq

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.finished_runs.run_frames import PersonPositions, check_frames, run_frames
from peopleboy.scenarios.finished_runs.true_events import KINDS, PersonNames, TrueEvent, thing_names
from peopleboy.scenarios.recording.recording_file import is_recorded
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import write_png
from peopleboy.scenarios.run_folder.run_tables import LOCAL
from peopleboy.tracker.frame import DEPTH
from peopleboy.tracker.scene_model.scene import Change, Happening, Metres, VistaScene
from peopleboy.tracker.scene_model.scene_config import PeopleMaskConfig, SceneConfig
from peopleboy.tracker.scene_model.scene_model import SceneModel
from peopleboy.tracker.scene_model.vista_spaces import Surface

# Files that a scene model writes: one line per frame, and a map of the static scene.

LINES, MAP, BACKGROUND, RECORDING = "scene.jsonl", "static_map.ply", "background.png", "scene.rrd"
"""Output files in the folder of a scene model's run."""

_DIGITS = 3


def scene_line(scene: VistaScene) -> str:
    """Return a frame as a line of JSON: time, people, objects, and changes."""
    record = {
        "time_s": scene.time_s,
        "vista": scene.vista,
        "is_frozen": scene.is_frozen,
        "persons": [asdict(one) for one in scene.persons],
        "objects": [asdict(one) for one in scene.objects],
        "happenings": [asdict(one) for one in scene.happenings],
    }
    return json.dumps(_rounded(record)) + "\n"


def write_map(surface: Surface, path: Path) -> None:
    """Write points and normals as a binary PLY file, in the frame of the robot's start pose [m].

    Normals point towards the camera, as viewers and registration expect.
    """
    names = ("x", "y", "z", "nx", "ny", "nz")
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(surface.points_m)}"]
    head += [*(f"property float {name}" for name in names), "end_header", ""]
    rows = np.concatenate([surface.points_m, -surface.normals], axis=1).astype("<f4")
    path.write_bytes("\n".join(head).encode() + rows.tobytes())


def write_background(depth_m: Metres, path: Path) -> None:
    """Write (H, W) depths [m] as a 16-bit image in millimetres; 0 for unknown depth."""
    write_png(path, np.rint(1000.0 * np.minimum(depth_m, 65.0)).astype(np.uint16))


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS)
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list | tuple) else value


# Changes as text.

_DONE: Final = {Change.APPEARED: "put down", Change.VANISHED: "took away", Change.MOVED: "moved"}
_ALONE: Final = {Change.APPEARED: "appeared", Change.VANISHED: "vanished", Change.MOVED: "moved"}


def describe_change(
    happening: Happening,
    person_name: Callable[[int | None], str | None] = lambda number: None,  # noqa: ARG005
    thing_name: str | None = None,
) -> str:
    """Describe a change, such as "6.0 s: person 1 moved object 2 by 1.1 m", with names if they are known."""
    thing = thing_name or f"object {happening.object}"
    way = f" by {happening.way_m:.1f} m" if happening.change is Change.MOVED else ""
    start = f"{happening.time_s:.1f} s: "
    if happening.person is None:
        return f"{start}{thing} {_ALONE[happening.change]}{way}"
    who = person_name(happening.person) or f"person {happening.person}"
    return f"{start}{who} {_DONE[happening.change]} {thing}{way}"


FOLDER = "scene"
"""Default output folder, in the folder of a run."""

Spot = tuple[float, float]
_PEOPLE = ("frame", "name", "x_m", "y_m", "whole_px", "hidden_by", "left_px", "id")


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneModelOptions:
    """Options of running a scene model.

    Attributes:
        has_heat: whether the thermal image separates people from objects.
        record: whether to write a recording.
    """

    has_heat: bool = True
    record: bool = True


def run_scene_model(
    run: FinishedRun, out: Path, options: SceneModelOptions, report: Callable[[int, int], None]
) -> list[str]:
    """Run a scene model on a run and write a folder, which replaces an earlier one.

    Args:
        run: run with images.
        out: output folder.
        options: options of the scene model.
        report: called after every frame with its number and the number of frames.

    Returns:
        The changes as text, from `describe_change`, in order of time.

    Raises:
        BadInput: the run has no images of a depth camera, or they are damaged.
    """
    check_frames(run)
    with atomic(out) as folder:
        folder.mkdir(parents=True)
        return _run(run, folder, options, report)


def _run(
    run: FinishedRun, folder: Path, options: SceneModelOptions, report: Callable[[int, int], None]
) -> list[str]:
    files = run.files(people=_PEOPLE)
    start = files.robot.slice(0, 1).to_pylist()[0]
    first = Pose2(start["x_m"], start["y_m"], start["heading_rad"])
    people = {k: [(row["name"], first.to_local((row["x_m"], row["y_m"]))) for row in rows]
              for k, rows in files.people_by_frame().items()}  # fmt: skip
    model = SceneModel(SceneConfig(people=PeopleMaskConfig(has_heat=options.has_heat)))
    who, bodies, happenings = PersonNames(), PersonPositions(), list[Happening]()
    with ExitStack() as stack:
        lines = stack.enter_context((folder / LINES).open("w", encoding="utf-8"))
        layer = None
        if is_recorded(options.record):
            from peopleboy.scenarios.recording.scene_layer import SceneRecording  # here, as it loads rerun

            layer = stack.enter_context(SceneRecording(folder / RECORDING, _title(run), first))
        for frame in run_frames(run):
            number = round(frame.time_s * run.rate_hz) + 1
            scene = model.update(frame)
            lines.write(scene_line(scene))
            who.look([(one.id, one.place_m) for one in scene.persons], people.get(number, []))
            bodies.look(frame.time_s, [one.place_m for one in scene.persons])
            happenings += [one for one in scene.happenings if not bodies.explain(one)]
            if layer is not None:
                depth = (frame.depth(DEPTH) / 1000.0).astype(np.float32)
                layer.log(number, scene, depth, model.geometry, model.pose)
            report(number, run.frames)
        happenings += [one for one in model.finish() if not bodies.explain(one)]
        write_map(model.static_map(), folder / MAP)
        write_background(scene.background_m, folder / BACKGROUND)
        described = _describe(happenings, who, true_events(run), first)
        if layer is not None:
            layer.log_map(model.static_map())
            layer.log_events([(happening.known_s, line) for happening, line in described])
    return [line for _, line in sorted(described, key=lambda one: one[0].time_s)]


def true_events(run: FinishedRun) -> list[TrueEvent]:
    """Read the true changes of objects from a run's event log and its table of objects."""
    lines = [line for line in run.events if line.kind in KINDS]
    path = run.folder / "truth" / "things.parquet"
    if not lines or not path.is_file():
        return []
    table = pq.read_table(
        path.absolute(), columns=["frame", "name", "x_m", "y_m"], filesystem=LOCAL
    ).to_pylist()
    places: dict[str, list[tuple[int, Spot]]] = defaultdict(list)
    for row in table:
        places[row["name"]].append((row["frame"], (row["x_m"], row["y_m"])))
    return [TrueEvent.of(one, one.who, one.other, _next(places[one.who], one.frame)) for one in lines]


def _next(places: Sequence[tuple[int, Spot]], frame: int) -> Spot:
    """Return the position at a frame, or at the next one with an image, or else at the last one."""
    at = bisect_left(places, frame, key=lambda one: one[0])
    return places[min(at, len(places) - 1)][1]


def _describe(
    happenings: Sequence[Happening], who: PersonNames, events: Sequence[TrueEvent], first: Pose2
) -> list[tuple[Happening, str]]:
    """Describe changes, with the names of the objects from the ground truth."""
    happenings = _without_halves(happenings)
    names = thing_names(happenings, events, first)
    return [(one, describe_change(one, who.name, names.get(one.object))) for one in happenings]


def _without_halves(happenings: Sequence[Happening]) -> list[Happening]:
    """Drop an appearance and a disappearance that were later found to be one move."""
    moved = [one for one in happenings if one.change is Change.MOVED]
    ends = {end for one in moved for end in (one.from_m, one.to_m)}
    others = [one for one in happenings if one.change is not Change.MOVED]
    return [*moved, *(one for one in others if (one.from_m or one.to_m) not in ends)]


def _title(run: FinishedRun) -> str:
    return f"{run.about.scenario}, seed {run.about.seed}, tracker {run.about.tracker}"
