"""The formats, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.by_split import by_split
from peopleboy.scenarios.export.coco import write_coco
from peopleboy.scenarios.export.label_images import write_label_images
from peopleboy.scenarios.export.mot import write_mot
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.export.ros.bag import write_mcap
from peopleboy.scenarios.export.video import write_mp4
from peopleboy.scenarios.export.viper import write_viper
from peopleboy.scenarios.export.yolo import write_yolo, write_yolo_pose
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.whole_folder import whole_folder
from peopleboy.scenarios.scores.yardstick import CALLED, boxed_cameras, kind_of_boxes
from peopleboy.tracker.footage.box_kinds import BoxKind

WRITERS: dict[str, Callable[..., None]] = {
    "mot": write_mot,
    "coco": write_coco,
    "images": write_label_images,
    "yolo": write_yolo,
    "yolo-pose": write_yolo_pose,
    "viper": write_viper,
    "mcap": write_mcap,
    "mp4": write_mp4,
}
OF_BOXES = ("yolo", "yolo-pose")  # for training; slivers can be left out
OF_EITHER_KIND = ("mot",)  # boxes of its truth are round torsos or whole people, as one likes
OF_ONE_CAMERA = ("mot", "yolo", "yolo-pose", "viper", "mp4")  # the others tell of all


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
    """Write runs in one of `WRITERS`, whole or not at all.

    Args:
        runs: which.
        form: name of the format.
        out: the folder to leave.
        play: gives a run's ticks, as `replay` does.
        camera: whose images and boxes, for a format `OF_ONE_CAMERA`; None for what it usually tells.
        least_px: how wide and high boxes must be [px], for a format `OF_BOXES`; None for what is usual.
        boxes: what the truth's are drawn round, for a format `OF_EITHER_KIND`; None for torsos.
        overwrite: whether an earlier export there may be replaced.

    Raises:
        BadInput: the runs cannot be written so, or there.
    """
    if camera is not None and form not in OF_ONE_CAMERA:
        raise BadInput(f"--camera {camera}: {form} has the images of every camera; leave it out")
    if least_px is not None and form not in OF_BOXES:
        raise BadInput(
            f"--least-px {least_px:g}: {form} has everybody of whom a pixel is visible; leave it out"
        )
    if boxes is not None and form not in OF_EITHER_KIND:
        raise BadInput(f"--boxes {boxes}: only {', '.join(OF_EITHER_KIND)} has boxes of either; leave it out")
    about: dict[str, Any] = {"format": form, "runs": [run.name for run in runs], "versions": versions()}
    splits = {split: [run.name for run in own] for split, own in by_split(runs).items() if split}
    about |= {"splits": splits} if splits else {}
    asked: dict[str, Any] = {"camera": camera, "least_px": least_px, "boxes": boxes}
    chosen = {name: value for name, value in asked.items() if value is not None}
    with whole_folder(out, about | chosen, overwrite=overwrite) as folder:
        WRITERS[form](runs, folder, play, **chosen)


def notes_on(
    runs: Sequence[FinishedRun], form: str, camera: str | None, boxes: BoxKind | None
) -> Iterator[str]:
    """Say, once a tracker, whose boxes are of another kind than those of the truth beside which they lie."""
    if form not in OF_EITHER_KIND:
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
