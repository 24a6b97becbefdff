"""A run's folder for tracks that were made elsewhere: the run's truth and scenario, and these tracks."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.files.own_files import keep_own_files
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.import_tracks.foreign_tracks import UNKNOWN, foreign_tracks
from peopleboy.scenarios.recording.recorder import Recorder
from peopleboy.scenarios.run_folder.atomic_output import atomic, check_out, writing_to
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, open_whole_runs, read_run
from peopleboy.scenarios.run_folder.folder import RunFolder
from peopleboy.scenarios.run_folder.image_files import about_gains
from peopleboy.scenarios.running.run import Watchers
from peopleboy.scenarios.scores.run_scores import RunScores, score_run
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import TRACKERS

_KEPT = ("mounted_for_tracker", "behaviour")


@dataclass(frozen=True, slots=True, kw_only=True)
class Adoption:
    """Which tracks are adopted, and how.

    Attributes:
        run: folder of the run whose images they were made of.
        tracks: MOTChallenge results.
        name: what their tracker is called.
        out: the folder to leave.
        camera: in whose images the boxes are.
        boxes: what they are drawn round.
        record: whether to write recording.rrd.
        overwrite: whether an earlier run in that folder may be replaced.
    """

    run: Path
    tracks: Path
    name: str
    out: Path
    camera: str = THERMAL
    boxes: BoxKind = BoxKind.TORSO
    record: bool = True
    overwrite: bool = False


def adopt(what: Adoption, report: Callable[[int, int], None]) -> RunScores:
    """Play a run once more, and leave a folder as if a tracker had told these tracks.

    The robot drives as it did in the run, so that how well it drove is not scored.

    Args:
        what: to be adopted.
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
        if what.record:
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


def check_adoption(what: Adoption) -> None:
    """Refuse what cannot be adopted, without writing anything.

    Raises:
        BadInput: run, tracks, name or the folder to leave cannot be used.
    """
    _look_at(what)
    check_out(what.out, "run", overwrite=what.overwrite)


def _look_at(what: Adoption) -> tuple[FinishedRun, Mapping[int, tuple[Track, ...]]]:
    _check_name(what.name)
    (run,) = open_whole_runs([what.run])
    return run, foreign_tracks(what.tracks, run, what.camera)


def _check_name(name: str) -> None:
    if name in (*TRACKERS, ORACLE):
        raise BadInput(f"--name {name}: is a tracker of ours; give another one")
    if not re.fullmatch(r"\w[\w.+-]*", name):
        raise BadInput(f"--name {name!r}: must be letters, digits, and _ . + - after the first")


def _about(what: Adoption, run: FinishedRun) -> dict[str, Any]:
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
