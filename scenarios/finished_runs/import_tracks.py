"""Import tracks that another program computed from the images of a run, as a separate run."""

import re
from collections import defaultdict
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.replay import OneCamera, one_camera, replay
from peopleboy.scenarios.files.own_files import keep_own_files
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.recording.recording_file import is_recorded
from peopleboy.scenarios.run_folder.atomic_output import atomic, check_out, writing_to
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, open_whole_runs, read_run, runs_in
from peopleboy.scenarios.run_folder.folder import RunFolder
from peopleboy.scenarios.run_folder.image_files import about_gains
from peopleboy.scenarios.run_folder.run_files import check_end
from peopleboy.scenarios.running.run import RunObservers
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.run_scores import RunScores, score_run
from peopleboy.settings import meaning_of
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.tracker.boxes import centres_outside
from peopleboy.tracker.evaluation.mot_files import read_tracks
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Status, Track
from peopleboy.tracker.trackers import TRACKERS

UNKNOWN = ("status", "place", "occluder", "posture")
"""Attributes of a track that MOTChallenge text does not contain."""

_MOST_OUTSIDE = 0.5  # share of the boxes; more suggests another run, camera or image size


def foreign_tracks(path: Path, run: FinishedRun, camera: str) -> Mapping[int, tuple[Track, ...]]:
    """Read MOTChallenge results, and return the tracks of each frame of the run that has any.

    Frames are counted as in exports, 1, 2, 3 ..., even for a camera that skips most frames of the run. Status
    and floor position are unknown; the age is counted from the first box.

    Args:
        path: MOTChallenge file.
        run: run whose images were used.
        camera: camera in whose images the boxes are.

    Raises:
        BadInput: the file is malformed, or cannot be of this run and camera.
    """
    boxes = read_tracks(path)
    shots = _shots(run, camera)
    _check_end(boxes, path, shots)
    _check_view(boxes, path, shots)
    if len(boxes) and boxes.id.min() < 1:
        raise BadInput(f"{path}: ids must be at least 1, got 0; add 1 to all")
    first: dict[int, float] = {}
    found: dict[int, list[Track]] = defaultdict(list)
    columns = (boxes.frame.tolist(), boxes.id.tolist(), boxes.box.tolist(), boxes.confidence.tolist())
    for image, number, (left, top, width, height), confidence in zip(*columns, strict=True):
        frame = shots.frames[image - 1]
        time_s = run.time_s(frame)
        found[frame].append(
            Track(
                id=number,
                boxes={camera: (left, top, width, height)},
                confidence=confidence,
                status=Status.UNKNOWN,
                age_s=time_s - first.setdefault(number, time_s),
            )
        )
    return {frame: tuple(tracks) for frame, tracks in found.items()}


def _shots(run: FinishedRun, camera: str) -> OneCamera:
    """Return the images of a camera, which the run may not have."""
    known = with_boxes(run.robot.cameras)
    if camera not in known:
        raise BadInput(f"--camera: unknown camera {camera!r}; choose from {', '.join(known)}")
    return one_camera(run, camera)


def _check_end(boxes: TrackBoxes, path: Path, shots: OneCamera) -> None:
    """Refuse boxes beyond the last image, for example if frames of the run were counted, not images."""
    if shots.every == 1:
        check_end(boxes, path, shots.run.frames)
    elif boxes.last_frame > len(shots.frames):
        raise BadInput(
            f"{path}: must end with image {len(shots.frames)}, the last of camera {shots.name!r}, got "
            f"{boxes.last_frame}; count the camera's images 1, 2, 3 ... as in exports, not frames of the run"
        )


def _check_view(boxes: TrackBoxes, path: Path, shots: OneCamera) -> None:
    """Refuse boxes that are mostly outside the camera's image."""
    width, height = shots.size
    outside = centres_outside(boxes.box, width, height)
    if len(boxes) and outside.mean() > _MOST_OUTSIDE:
        raise BadInput(
            f"{path}: boxes must be in pixels of the {width} x {height} images of camera {shots.name!r}; "
            f"{outside.mean():.0%} of them have their centre outside"
        )


_KEPT = ("mounted_for_tracker", "behaviour")


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackImport:
    """Tracks to import, with options.

    Attributes:
        run: folder of the run whose images were used.
        tracks: MOTChallenge results.
    """

    run: Path
    tracks: Path
    name: Annotated[str, Field(description="Name of the tracker that produced the tracks.")]
    out: Annotated[Path, Field(description="Output folder.")]
    camera: Annotated[str, Field(description="Camera whose images the boxes refer to.")] = THERMAL
    boxes: Annotated[BoxKind, meaning_of(RunOptions, "boxes")] = BoxKind.TORSO
    record: Annotated[bool, meaning_of(RunOptions, "record")] = True
    overwrite: Annotated[bool, meaning_of(RunOptions, "overwrite")] = False


def import_tracks(what: TrackImport, report: Callable[[int, int], None]) -> RunScores:
    """Replay a run and write a folder as if a tracker had returned these tracks.

    The robot drives as in the original run, so its driving is not scored.

    Args:
        what: tracks to import, with options.
        report: called after each frame with its number and the number of frames.

    Raises:
        BadInput: run, tracks or name are invalid; nothing is written.
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
        observers = RunObservers(run.world, title, recorder, faults=run.scenario.faults)
        for played in replay(run):
            why, theirs = whys.get(played.frame, ""), tracks.get(played.frame, ())
            tick = replace(played, tracks=theirs, explanation=None, reason=why)
            events = observers.update(tick)
            folder.write(tick, [event.to_json() for event in events])
            report(tick.frame, run.frames)
        folder.flush()
        scores = score_run(part, run.frames, None, what.boxes)
        observers.save(part)
        folder.complete(scores.to_json())
    return scores


def check_import(what: TrackImport) -> None:
    """Check whether tracks can be imported, without writing anything.

    Raises:
        BadInput: run, tracks, name or output folder are invalid.
    """
    _look_at(what)
    check_out(what.out, "run", overwrite=what.overwrite)


def _look_at(what: TrackImport) -> tuple[FinishedRun, Mapping[int, tuple[Track, ...]]]:
    _check_name(what.name)
    (run,) = open_whole_runs([what.run])
    return run, foreign_tracks(what.tracks, run, what.camera)


def _check_name(name: str) -> None:
    if name in (*TRACKERS, ORACLE):
        raise BadInput(f"--name {name}: is a tracker of PeopleBoy; give another name")
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


# Results of a whole benchmark: one file of tracks per sequence.


def imports_by_sequence(what: TrackImport) -> list[TrackImport]:
    """Return one import for each sequence in a folder of results, `SEQUENCE.txt` or `data/SEQUENCE.txt`.

    Sequences are named SCENARIO-SEED, as in exports of runs. Each is written to a folder of that name in
    `what.out`.

    Args:
        what: options, with a folder of runs as `run`, and a folder of results for all of them as `tracks`.

    Raises:
        BadInput: a run has no file, a file has no run, or one of them is invalid.
    """
    files = _files(what.tracks)
    runs = _by_sequence(what.run)
    for name in sorted(files.keys() ^ runs.keys()):
        if name in runs:
            raise BadInput(f"{what.tracks}: has no {name}.txt, the tracks of {runs[name].folder}")
        raise BadInput(f"{files[name]}: no run with that name in {what.run}, which has {', '.join(runs)}")
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
