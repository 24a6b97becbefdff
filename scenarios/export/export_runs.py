"""Export runs in one of the formats, whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.formats import FORMATS, takes
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.run_folder.atomic_output import atomic_folder
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.scores.reference_boxes import CALLED, boxed_cameras, kind_of_boxes
from peopleboy.tracker.footage.box_kinds import BoxKind


def export(
    runs: Sequence[FinishedRun],
    form: str,
    out: Path,
    play: Play,
    *,
    camera: str | None = None,
    least_px: float | None = None,
    boxes: BoxKind | None = None,
    overwrite: bool,
) -> None:
    """Write runs in one of the formats, whole or not at all.

    Args:
        runs: which.
        form: name of the format, one of `FORMATS`.
        out: the folder to leave.
        play: gives a run's ticks, as `replay` does.
        camera: whose images and boxes, for a format of one camera; None for its usual one.
        least_px: how wide and high boxes must be [px], for a format to train on; None for its usual value.
        boxes: what the truth's are drawn round, for a format with either kind; None for torsos.
        overwrite: whether an earlier export there may be replaced.

    Raises:
        BadInput: the runs cannot be written so, or there.
    """
    if camera is not None and not takes(form, "camera"):
        raise BadInput(f"--camera {camera}: {form} has the images of every camera; leave it out")
    if least_px is not None and not takes(form, "least_px"):
        raise BadInput(
            f"--least-px {least_px:g}: {form} has everybody of whom a pixel is visible; leave it out"
        )
    if boxes is not None and not takes(form, "boxes"):
        having = [name for name in FORMATS if takes(name, "boxes")]
        raise BadInput(f"--boxes {boxes}: only {', '.join(having)} has boxes of either; leave it out")
    about: dict[str, Any] = {"format": form, "runs": [run.name for run in runs], "versions": versions()}
    splits = {split: [run.name for run in own] for split, own in by_split(runs).items() if split}
    about |= {"splits": splits} if splits else {}
    asked: dict[str, Any] = {"camera": camera, "least_px": least_px, "boxes": boxes}
    chosen = {name: value for name, value in asked.items() if value is not None}
    with atomic_folder(out, about | chosen, overwrite=overwrite) as folder:
        FORMATS[form](runs, folder, play, **chosen)


def notes_on(
    runs: Sequence[FinishedRun], form: str, camera: str | None, boxes: BoxKind | None
) -> Iterator[str]:
    """Say, once a tracker, whose boxes are of another kind than those of the truth beside which they lie."""
    if not takes(form, "boxes"):
        return
    there, name = boxes or BoxKind.TORSO, camera or "thermal"
    kinds = {
        run.about.tracker: kind_of_boxes(run.folder, name, run.about.tracker, BoxKind(run.about.boxes))
        for run in runs
        if name in boxed_cameras(run.folder)
    }
    for tracker, kind in kinds.items():
        if kind is not there:
            yield (
                f"boxes of tracker {tracker} are round {CALLED[kind]}, those of gt.txt round {CALLED[there]};"
                f" --boxes {kind} has those of gt.txt round {CALLED[kind]}, too"
            )
