"""Import tracks that another program made of the images of a run, as a run of their own."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.files.own_files import keep_own_files
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.finished_runs.foreign_tracks import UNKNOWN, foreign_tracks
from peopleboy.scenarios.recording.recording_file import is_recorded
from peopleboy.scenarios.run_folder.atomic_output import atomic, check_out, writing_to
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, open_whole_runs, read_run, runs_in
from peopleboy.scenarios.run_folder.folder import RunFolder
from peopleboy.scenarios.run_folder.image_files import about_gains
from peopleboy.scenarios.running.run import Watchers
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.run_scores import RunScores, score_run
from peopleboy.settings import meaning_of
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import TRACKERS

_KEPT = ("mounted_for_tracker", "behaviour")


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackImport:
    """Which tracks to import, and how.

    Attributes:
        run: folder of the run whose images they were made of.
        tracks: MOTChallenge results.
    """

    run: Path
    tracks: Path
    name: Annotated[str, Field(description="What their tracker is called.")]
    out: Annotated[Path, Field(description="Folder to leave.")]
    camera: Annotated[str, Field(description="Camera in whose images the boxes are.")] = THERMAL
    boxes: Annotated[BoxKind, meaning_of(RunOptions, "boxes")] = BoxKind.TORSO
    record: Annotated[bool, meaning_of(RunOptions, "record")] = True
    overwrite: Annotated[bool, meaning_of(RunOptions, "overwrite")] = False


def import_tracks(what: TrackImport, report: Callable[[int, int], None]) -> RunScores:
    """Replay a run and write a folder as if a tracker had given these tracks.

    The robot drives as it did in the run, so that how well it drove is not scored.

    Args:
        what: to be imported.
        report: called after each frame with its number and the number of all.

    Raises:
        BadInput: run, tracks or name cannot be used; nothing is written then.
    """
    run, tracks = _look_at(what)
    whys = {line.frame: line.why for line in run.events if line.kind == "mode"}
    with writing_to(what.out), ExitStack() as stack:
        check_out(what.out, "run", overwrite=what.overwrite)
        part = stack.enter_context(atomic(what.out))
        part.mkdir(parents=True)
        cameras, has_images = run.robot.cameras, run.about.images
        folder = RunFolder(part, run.played, _about(what, run), cameras, frames=has_images)
        stack.enter_context(folder)
        keep_own_files(run.scenario.kept_files(), part)
        title = f"{run.title}, tracks of {what.name}"
        recorder = None
        if is_recorded(what.record):
            from peopleboy.scenarios.recording.recorder import Recorder  # here, as it loads rerun

            path = part / "recording.rrd"
            recorder = stack.enter_context(Recorder(path, run.world, title=title, watched=(what.camera,)))
        watchers = Watchers(run.world, title, recorder, faults=run.scenario.spec.faults)
        for played in replay(run):
            why, theirs = whys.get(played.frame, ""), tracks.get(played.frame, ())
            tick = replace(played, tracks=theirs, explanation=None, reason=why)
            events = watchers.update(tick)
            folder.write(tick, [event.to_json() for event in events])
            report(tick.frame, run.frames)
        folder.flush()
        scores = score_run(part, run.frames, following=None, boxes=what.boxes)
        watchers.save(part)
        folder.complete(scores.to_json())
    return scores


def check_import(what: TrackImport) -> None:
    """Refuse what cannot be imported, without writing anything.

    Raises:
        BadInput: run, tracks, name or the folder to leave cannot be used.
    """
    _look_at(what)
    check_out(what.out, "run", overwrite=what.overwrite)


def _look_at(what: TrackImport) -> tuple[FinishedRun, Mapping[int, tuple[Track, ...]]]:
    _check_name(what.name)
    (run,) = open_whole_runs([what.run])
    return run, foreign_tracks(what.tracks, run, what.camera)


def _check_name(name: str) -> None:
    if name in (*TRACKERS, ORACLE):
        raise BadInput(f"--name {name}: is a tracker of ours; give another one")
    if not re.fullmatch(r"\w[\w.+-]*", name):
        raise BadInput(f"--name {name!r}: must be letters, digits, and _ . + - after the first")


def _about(what: TrackImport, run: FinishedRun) -> dict[str, Any]:
    said = read_run(run.folder)
    return {
        "scenario": run.about.scenario,
        "seed": run.about.seed,
        "tracker": what.name,
        "boxes": what.boxes,
        "renderer": run.about.renderer,
        "rate_hz": run.rate_hz,
        "images": run.about.images,
        "gains": about_gains(run.robot.cameras),
        **{key: said[key] for key in _KEPT if key in said},
        "adopted": {
            "tracks": what.tracks.name,
            "camera": what.camera,
            "driven_by": run.about.adopted.driven_by if run.about.adopted else run.about.tracker,
            "unknown": list(UNKNOWN),
        },
    }


# Results of a whole benchmark: one file of tracks for each of its sequences.


def imports_by_sequence(what: TrackImport) -> list[TrackImport]:
    """Return one import for each sequence of a folder of results, `SEQUENCE.txt` or `data/SEQUENCE.txt`.

    Sequences are called SCENARIO-SEED, as exports of runs call them. Each is to be left in a folder of that
    name in `what.out`.

    Args:
        what: `run` is a folder of runs, and `tracks` one of results for all of them.

    Raises:
        BadInput: a run has no file, or a file no run, or one of them cannot be used.
    """
    files = _files(what.tracks)
    runs = _by_sequence(what.run)
    for name in sorted(files.keys() ^ runs.keys()):
        if name in runs:
            raise BadInput(f"{what.tracks}: has no {name}.txt, the tracks of {runs[name].folder}")
        raise BadInput(
            f"{files[name]}: there is no run of that name in {what.run}, which has {', '.join(runs)}"
        )
    imports = [
        replace(what, run=run.folder, tracks=files[name], out=what.out / name) for name, run in runs.items()
    ]
    for one in imports:
        check_import(one)
    return imports


def _files(folder: Path) -> dict[str, Path]:
    inner = folder / "data"
    found = {path.stem: path for path in sorted((inner if inner.is_dir() else folder).glob("*.txt"))}
    if not found:
        raise BadInput(f"{folder}: has no SEQUENCE.txt, nor has {inner}; give a file or folder of tracks")
    return found


def _by_sequence(folder: Path) -> dict[str, FinishedRun]:
    found: dict[str, FinishedRun] = {}
    for run in open_whole_runs(runs_in(folder)):
        name = f"{run.about.scenario}-{run.about.seed}"
        if name in found:
            raise BadInput(f"{run.folder}: same scenario and seed as {found[name].folder}; leave one out")
        found[name] = run
    return found
