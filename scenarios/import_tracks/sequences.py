"""A whole benchmark's results: a file of tracks for each of its sequences, held against the runs it is of."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.import_tracks.adopt import Adoption, check_adoption
from peopleboy.scenarios.run_folder.finished_run import FinishedRun, open_whole_runs, runs_in


def sequences(what: Adoption) -> list[Adoption]:
    """Give one adoption for each sequence of a folder of results, `SEQUENCE.txt` or `data/SEQUENCE.txt`.

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
    adoptions = [
        replace(what, run=run.folder, tracks=files[name], out=what.out / name) for name, run in runs.items()
    ]
    for adoption in adoptions:
        check_adoption(adoption)
    return adoptions


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
