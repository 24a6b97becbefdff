"""Export runs in one of the formats, completely or not at all."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.formats import FORMATS, SEQUENCES, takes
from peopleboy.scenarios.export.replay import counted, with_people
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.export.yolo import ENCLOSED, VISIBLE, WHOLE, usual_boxes
from peopleboy.scenarios.run_folder.atomic_output import atomic_folder
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.run_folder.frame_choice import (
    VISIBLE_COLUMNS,
    FrameChoice,
    chosen_frames,
    visible_rows,
)
from peopleboy.scenarios.run_folder.run_files import read_table, truth_files
from peopleboy.scenarios.run_folder.run_tables import TRUTH, Row
from peopleboy.scenarios.scores.evaluate_runs import CALLED, boxed_cameras, kind_of_boxes
from peopleboy.settings import Metavar
from peopleboy.tracker.footage.box_kinds import BoxKind

_YOLO: Final = ("yolo", "yolo-pose")
_BOXES: Final = {"mot": tuple(BoxKind), **dict.fromkeys(_YOLO, (VISIBLE, WHOLE))}


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportOptions:
    """Options of an export.

    Attributes:
        form: name of the format, one of `FORMATS`.
        choice: frames of each run to export.
    """

    form: str
    camera: Annotated[
        str | None,
        Field(
            description="Camera to export with mot, yolo, webdataset, huggingface, minari, lerobot, viper "
            "and mp4.  [default: thermal; for mp4, thermal and colour; for minari and lerobot, none]"
        ),
        Metavar("NAME"),
    ] = None
    least_px: Annotated[
        float | None,
        Field(
            ge=0.0,
            description="Minimum width and height of boxes in yolo and yolo-pose, in pixels; 0 keeps all "
            "boxes.  [default: 3]",
        ),
    ] = None
    boxes: Annotated[
        Literal["torso", "whole", "visible"] | None,
        Field(
            description="Ground-truth boxes: torso or whole person in mot, whole person or visible part in "
            "yolo and yolo-pose.  [default: torso in mot, visible in yolo, whole in yolo-pose]"
        ),
    ] = None
    epoch: Annotated[
        str | None,
        Field(
            description="Start of the timestamps in mcap: 0, now, or a time such as "
            "2026-05-01T12:00:00Z.  [default: 0]"
        ),
        Metavar("TIME"),
    ] = None
    ros_distro: Annotated[
        Literal["humble", "jazzy"] | None,
        Field(description="ROS distribution that defines the message types in mcap.  [default: jazzy]"),
    ] = None
    out: Annotated[Path, Field(description="Output folder.")]
    overwrite: Annotated[bool, Field(description="Replace an earlier export in the output folder.")] = False
    choice: FrameChoice = field(default_factory=FrameChoice)


def export(runs: Sequence[FinishedRun], options: ExportOptions, report: Callable[[int, int], None]) -> None:
    """Write runs in one of the formats, completely or not at all.

    Args:
        runs: the runs to write.
        options: the format and its options.
        report: called with the number of frames that were rendered again, and of all frames.

    Raises:
        BadInput: the runs cannot be written in this format, or to this folder.
    """
    chosen = _checked(options)
    runs = _with_chosen_frames(runs, options)
    about: dict[str, Any] = {"format": options.form, "runs": [run.name for run in runs]}
    about |= {"versions": versions()} | (
        {} if options.choice.is_all else {"choice": options.choice.to_json()}
    )
    splits = {split: [run.name for run in own] for split, own in by_split(runs).items() if split}
    about |= {"splits": splits} if splits else {}
    frames = sum(len(run.kept_frames) for run in runs)
    with atomic_folder(options.out, about | chosen, overwrite=options.overwrite) as folder:
        FORMATS[options.form](runs, folder, counted(lambda frame: report(frame, frames)), **chosen)


def _with_chosen_frames(runs: Sequence[FinishedRun], options: ExportOptions) -> list[FinishedRun]:
    """Return the runs with the chosen frames.

    Raises:
        BadInput: the format needs whole sequences, or no frame is suitable.
    """
    form, choice = options.form, options.choice
    if form in SEQUENCES and not choice.is_all:
        raise BadInput(f"{choice.options()}: {form} contains whole sequences; omit the option")
    for run in runs:
        if form in SEQUENCES and run.is_sampled:
            raise BadInput(f"{run.folder}: has chosen frames only, and {form} contains whole sequences")
    if choice.is_all:
        return list(runs)
    found = [replace(run, chosen=_chosen(run, choice, options.camera or "thermal")) for run in runs]
    if not any(run.chosen for run in found):
        raise BadInput(f"{choice.options()}: no frame of these runs is suitable; choose less strictly")
    return found


def _chosen(run: FinishedRun, choice: FrameChoice, camera: str) -> tuple[int, ...]:
    shots = with_people(run, camera)
    table = read_table(truth_files(run.folder, camera)[1], TRUTH, VISIBLE_COLUMNS)
    rows: dict[int, list[Row]] = defaultdict(list)
    for row in table.to_pylist():
        rows[row["frame"]].append(row)
    people = {frame: visible_rows(own) for frame, own in rows.items()}
    return chosen_frames(choice, shots.frames, people, run.about.seed)


def _checked(options: ExportOptions) -> dict[str, Any]:
    """Return the given options of the format.

    Raises:
        BadInput: the format does not have one of them.
    """
    form, camera, least_px, boxes = options.form, options.camera, options.least_px, options.boxes
    if camera is not None and not takes(form, "camera"):
        raise BadInput(f"--camera {camera}: {form} contains the images of every camera; omit the option")
    if least_px is not None and not takes(form, "least_px"):
        raise BadInput(
            f"--least-px {least_px:g}: {form} contains everyone with a visible pixel; omit this option"
        )
    if boxes is not None and not takes(form, "boxes"):
        having = [name for name in FORMATS if takes(name, "boxes")]
        raise BadInput(f"--boxes {boxes}: only {', '.join(having)} have a choice of boxes; omit the option")
    if boxes is not None and boxes not in (choices := _BOXES.get(form, (boxes,))):
        raise BadInput(f"--boxes {boxes}: {form} has {' or '.join(choices)}; choose one of them")
    for option, value in (("epoch", options.epoch), ("ros_distro", options.ros_distro)):
        if value is not None and not takes(form, option):
            raise BadInput(f"--{option.replace('_', '-')} {value}: applies to mcap only; omit the option")
    asked: dict[str, Any] = {
        "camera": camera, "least_px": least_px, "epoch": options.epoch, "ros_distro": options.ros_distro,
        "boxes": BoxKind(boxes) if form == "mot" and boxes else boxes,
    }  # fmt: skip
    return {name: value for name, value in asked.items() if value is not None}


def notes_on(runs: Sequence[FinishedRun], options: ExportOptions) -> Iterator[str]:
    """Return notes on runs that were cut off, and on boxes of another kind than the truth's."""
    yield from (f"{run.folder}: {run.incomplete}" for run in runs if run.incomplete)
    if options.form in _YOLO and options.boxes is None:
        kind = usual_boxes(has_poses=options.form != _YOLO[0])
        other = VISIBLE if kind == WHOLE else WHOLE
        yield f"boxes enclose {ENCLOSED[kind]}; with --boxes {other}, {ENCLOSED[other]}"
    if options.form != "mot":
        return
    there, name = BoxKind(options.boxes or BoxKind.TORSO), options.camera or "thermal"
    kinds = {
        run.about.tracker: kind_of_boxes(run.folder, name, run.about.tracker, BoxKind(run.about.boxes))
        for run in runs
        if name in boxed_cameras(run.folder)
    }
    for tracker, kind in kinds.items():
        if kind is not there:
            yield (
                f"boxes of tracker {tracker} enclose {CALLED[kind]}, those of gt.txt {CALLED[there]};"
                f" with --boxes {kind}, those of gt.txt enclose {CALLED[kind]} too"
            )
