"""YOLO: a folder of boxes or poses in the format of Ultralytics and common loaders.

data.yaml                      folders of each split; classes; keypoints and their mirror images
images/train/RUN_000001.png    images of the camera
labels/train/RUN_000001.txt    class, and middle, width and height of the box, as shares of the image; of
poses
                               also u, v and visibility of each keypoint

Boxes enclose the visible part of a person, as detectors are trained, or the whole person as far as it is
inside the image. Poses have whole boxes by default, so that hidden keypoints are inside them.

Runs outside a rendered set have no splits: they are in images/all, which data.yaml names for training and for
validation, as YOLO requires both. A person across a panorama's seam has two boxes; each keypoint belongs to
the nearer one. Slivers are omitted: boxes narrower or lower than 3 px, or another limit, as Ultralytics drops
boxes of up to 2 px from augmented images.
"""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import yaml

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import box_parts
from peopleboy.scenarios.export.replay import (
    CORNER_PX,
    OUTSIDE,
    Keypoint,
    OneCamera,
    Play,
    keypoints_from_corner,
    with_people,
    write_camera_images,
)
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.run_files import read_table, truth_files
from peopleboy.scenarios.run_folder.run_tables import TRUTH, Row
from peopleboy.sim.cameras.kinds import kind_of
from peopleboy.sim.people.body.skeleton import JOINT_NAMES
from peopleboy.sim.truth.truth import Box
from peopleboy.tracker.boxes import within_image

EVERYTHING: Final = "all"

LEAST_PX: Final = 3.0
_PERSON: Final = 0  # YOLO counts classes from 0
_EDGES: Final = tuple(f"visible_{edge}_px" for edge in ("left", "top", "width", "height"))
_WHOLE_EDGES: Final = tuple(f"whole_{edge}_px" for edge in ("left", "top", "width", "height"))
VISIBLE: Final = "visible"
WHOLE: Final = "whole"
ENCLOSED: Final = {VISIBLE: "the visible part of people", WHOLE: "whole people, hidden parts included"}
_COLUMNS: Final = ("frame", "id", *_EDGES, *_WHOLE_EDGES, "joints_px", "joint_is_visible")


def write_yolo(
    runs: Sequence[FinishedRun],
    folder: Path,
    play: Play,
    camera: str = "thermal",
    least_px: float = LEAST_PX,
    boxes: str | None = None,
    *,
    has_poses: bool = False,
) -> None:
    """Write boxes of people, except of people whose visible part is narrower or lower than `least_px`.

    Args:
        runs: the runs to write.
        folder: output folder.
        play: returns the ticks of a run.
        camera: camera of the images and boxes.
        least_px: minimum width and height of the visible part [px].
        boxes: "visible" or "whole"; None for the usual ones, whole with poses and visible without.
        has_poses: whether labels include the 17 keypoints of COCO.

    Raises:
        BadInput: some runs have splits and others do not, or one has no such 8-bit camera.
    """
    kind = boxes or usual_boxes(has_poses=has_poses)
    what = _Labels(camera, least_px, has_poses, kind == WHOLE)
    sorted_runs = {
        split or EVERYTHING: [_eight_bits(run, camera) for run in own]
        for split, own in by_split(runs).items()
    }
    settings = yaml.safe_dump(_settings(sorted_runs, has_poses), sort_keys=False, default_flow_style=None)
    heading = f"# boxes enclose {ENCLOSED[kind]}\n"
    (folder / "data.yaml").write_text(heading + settings, encoding="utf-8")
    for split, every in sorted_runs.items():
        images, labels = (folder / kind / split for kind in ("images", "labels"))
        for place in (images, labels):
            place.mkdir(parents=True)
        for shots in every:
            for number, text in _labels(shots, what):
                (labels / f"{_stem(shots, number)}.txt").write_text(text, encoding="utf-8")
            _write_images(shots, images, play)


def usual_boxes(*, has_poses: bool) -> str:
    """Return what boxes enclose by default."""
    return WHOLE if has_poses else VISIBLE


write_yolo_pose = partial(write_yolo, has_poses=True)


class _Labels(NamedTuple):
    """What is exported: camera, minimum size [px], and whether there are poses and boxes are whole."""

    camera: str
    least_px: float
    has_poses: bool
    is_whole: bool


def _write_images(shots: OneCamera, folder: Path, play: Play) -> None:
    write_camera_images(shots, play, lambda number: folder / f"{_stem(shots, number)}.png")


def _stem(shots: OneCamera, number: int) -> str:
    """Return the stem of the files of an image and its labels."""
    return f"{shots.run.name}_{number:06d}"


def _eight_bits(run: FinishedRun, camera: str) -> OneCamera:
    found = with_people(run, camera)
    if kind_of(run.robot.cameras[camera]).dtype is not np.uint8:
        raise BadInput(
            f"{run.folder}: camera {camera!r} has 16-bit images, which YOLO truncates; give another camera"
        )
    return found


def _settings(splits: Collection[str], has_poses: bool) -> Mapping[str, Any]:
    """Return the content of data.yaml; its folders are relative to its own place."""
    named = {split: f"images/{split}" for split in splits}
    if EVERYTHING in named:
        named = dict.fromkeys(("train", "val"), named[EVERYTHING])
    poses = {"kpt_shape": [len(JOINT_NAMES), 3], "flip_idx": _mirrored()} if has_poses else {}
    return {**named, **poses, "names": {_PERSON: "person"}}


def _mirrored() -> list[int]:
    """Return the index of each keypoint's mirror image."""
    swapped = str.maketrans({"<": "right_", ">": "left_"})
    marked = [name.replace("left_", "<").replace("right_", ">") for name in JOINT_NAMES]
    return [JOINT_NAMES.index(name.translate(swapped)) for name in marked]


def _labels(shots: OneCamera, what: _Labels) -> Iterator[tuple[int, str]]:
    """Yield the labels of each image, one line per box; none for an image without people."""
    _, table = truth_files(shots.run.folder, shots.name)
    people: dict[int, list[Row]] = defaultdict(list)
    for row in read_table(table, TRUTH, _COLUMNS).to_pylist():
        if row[_EDGES[0]] is not None:
            people[row["frame"]].append(row)
    for frame in shots.frames:
        lines = [line for row in people[frame] for line in _lines(row, shots, what)]
        yield shots.number(frame), "".join(f"{line}\n" for line in lines)


def _lines(row: Row, shots: OneCamera, what: _Labels) -> Iterator[str]:
    if min(row[edge] for edge in _EDGES[2:]) < what.least_px:
        return
    left, top, width, height = (row[edge] for edge in _EDGES)
    parts = box_parts((left, top, width, height), shots.camera)
    if what.is_whole:
        whole = box_parts(tuple(row[edge] for edge in _WHOLE_EDGES), shots.camera)
        parts = tuple(_inside(part, shots) for part in whole) if len(whole) >= len(parts) else parts
    joints = np.reshape(row["joints_px"], (-1, 2)).tolist()
    points = keypoints_from_corner(joints, row["joint_is_visible"], shots.size) if what.has_poses else []
    for part in parts:
        if min(part[2:]) >= what.least_px:
            yield " ".join([str(_PERSON), *_middle(part, shots), *_poses(points, part, parts, shots)])


def _inside(box: Box, shots: OneCamera) -> Box:
    """Clip a box to the image, whose corner is half a pixel from the middle of the first pixel."""
    from_corner = np.array([box[0] + CORNER_PX, box[1] + CORNER_PX, *box[2:]])
    left, top, width, height = within_image(from_corner, *shots.size).tolist()
    return left - CORNER_PX, top - CORNER_PX, width, height


def _middle(box: Box, shots: OneCamera) -> Iterator[str]:
    """Return middle, width and height as shares of the image."""
    left, top, width, height = box
    columns, rows = shots.size
    middle = ((left + CORNER_PX + width / 2) / columns, (top + CORNER_PX + height / 2) / rows)
    shares = (*middle, width / columns, height / rows)
    return (f"{share:.7f}" for share in shares)


def _poses(points: Sequence[Keypoint], part: Box, parts: Sequence[Box], shots: OneCamera) -> Iterator[str]:
    """Return keypoints as shares of the image; for a box in two parts, those nearer to this part."""
    columns, rows = shots.size
    for u, v, flag in points:
        is_here = flag != OUTSIDE and min(parts, key=lambda other: _aside(u, other)) == part
        yield f"{u / columns:.7f} {v / rows:.7f} {flag}" if is_here else f"0.0000000 0.0000000 {OUTSIDE}"


def _aside(u: float, box: Box) -> float:
    """Return the distance of a column from the middle of a box [px]."""
    return abs(u - CORNER_PX - box[0] - box[2] / 2)
