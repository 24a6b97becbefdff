"""Whether a run is there already, so that a sweep or a suite that was killed goes on where it was."""

from __future__ import annotations

from pathlib import Path

import yaml

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.own_files import are_kept
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.tracker_by_name import camera_names
from peopleboy.scenarios.run_folder.finished_run import open_run, read_run
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.run import RunOptions, tracker_name


def is_finished(scenario: Scenario, options: RunOptions) -> bool:
    """Tell whether the folder holds this very run, complete, with its images if they are wanted.

    Never, if it is to be replaced.

    Raises:
        BadInput: it holds a complete run of another scenario, seed, tracker, kind of boxes or version, or a
            spoilt one.
    """
    if options.overwrite or not _is_complete(options.out):
        return False
    run = open_run(options.out)
    tracker = tracker_name(scenario, options)
    if run.about.tracker != tracker:
        raise BadInput(
            f"{options.out}: was run with tracker {run.about.tracker!r}; give --overwrite, or another --out"
        )
    if run.about.boxes != options.boxes:
        raise BadInput(
            f"{options.out}: was run with --boxes {run.about.boxes}; give --overwrite, or another --out"
        )
    if run.about.behaviour != scenario.own_behaviour:
        was = run.about.behaviour or run.scenario.robot.behaviour
        raise BadInput(f"{options.out}: was run with behaviour {was!r}; give --overwrite, or another --out")
    if options.frames and not run.about.images:
        return False
    mounted = scenario.mounting(camera_names(tracker))
    resolved = _as_read(mounted.resolved(options.seed, versions()))
    if (run.played, run.about.renderer) != (resolved, options.renderer) or not are_kept(
        scenario.kept_files(), options.out
    ):
        raise BadInput(
            f"{options.out}: is a run of another scenario or version; give --overwrite, or another --out"
        )
    return True


def _is_complete(folder: Path) -> bool:
    try:
        read_run(folder)
    except BadInput:
        return False
    return True


def _as_read(data: object) -> object:
    return yaml.safe_load(yaml.safe_dump(data))
