"""Scores of finished runs, from the files in their folders."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bad_input import BadInput
from scenarios.footage.truth_files import find_truth, load_truth
from tracker.evaluation.evaluate import Scores, evaluate
from tracker.evaluation.mot_files import read_tracks
from tracker.evaluation.sequence import Rows
from tracker.evaluation.uncounted import MIN_VISIBLE


def evaluate_files(
    truth: Path, tracks: Path, frames: int | None = None, min_visible: float = MIN_VISIBLE
) -> Scores:
    """Score MOTChallenge tracks against truth of any format that footage comes with.

    People of whom no more than min_visible is seen do not count. Figures that need everybody are undefined
    where the truth has one person alone.
    """
    given, found = load_truth(truth, None), read_tracks(tracks)
    if frames is not None:
        check_end(given.truth, truth, frames)
        check_end(found, tracks, frames)
    return evaluate(
        given.truth,
        found,
        frames=frames,
        min_visible=min_visible,
        is_single=given.is_single,
    )


def evaluate_runs(folders: Sequence[Path], min_visible: float = MIN_VISIBLE) -> list[Scores]:
    """Score the runs in these folders, one by one; min_visible as for files.

    Raises:
        BadInput: a folder holds no run, or one that was cut off, or of footage without truth.
    """
    return [_evaluate_run(folder, min_visible) for folder in folders]


def check_end(rows: Rows, path: Path, frames: int) -> None:
    """Refuse a file that goes on after the run.

    Raises:
        BadInput: it does.
    """
    if rows.last_frame > frames:
        raise BadInput(f"{path}: must end with frame {frames}, the run's last, got {rows.last_frame}")


def runs_in(folder: Path) -> list[Path]:
    """List the folders of runs that a folder stands for: itself, or those in it.

    Raises:
        BadInput: there is no such folder.
    """
    if not folder.is_dir():
        raise BadInput(f"{folder}: there is no such folder; give the folder of a finished run")
    inner = sorted(path.parent for path in folder.glob("*/run.json"))
    return inner if inner and not (folder / "run.json").exists() else [folder]


def read_run(folder: Path) -> dict[str, Any]:
    """Read what run.json says of a complete run.

    Raises:
        BadInput: there is no run, or it is not complete.
    """
    path = folder / "run.json"
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read as a run; give the folder of a finished run") from error
    if not isinstance(about, dict) or about.get("status") != "complete":
        raise BadInput(
            f"{path}: this run was cut off; run it again, or score its files with --truth and --tracks"
        )
    if not isinstance(about.get("frames"), int):
        raise BadInput(f"{path}: frames: must be a whole number, got {about.get('frames')!r}; run it again")
    return about


def _evaluate_run(folder: Path, min_visible: float) -> Scores:
    about, truth = read_run(folder), find_truth(folder)
    if truth is None:
        raise BadInput(f"{folder}: has no truth to score against; give --truth with --tracks")
    return evaluate_files(truth, folder / "tracks.txt", about["frames"], min_visible)
