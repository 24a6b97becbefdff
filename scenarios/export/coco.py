"""COCO: images, masks, boxes and keypoints of all visible people, and the ground truth of each image.

    annotations/person_keypoints.json                  of the thermal images
    annotations/CAMERA/person_keypoints.json           of the images of any other camera, such as colour
    images/RUN/thermal/000001.png, thermal16/..., colour/...

and for runs of a rendered set, which has splits:

    annotations/person_keypoints_train.json, ..._val.json, ..._test.json
    images/train/RUN/thermal/000001.png, ...

File names in an annotation file are relative to `images`, or to `images/train`.

COCO counts pixels from the image's corner: the middle of the top-left pixel is (0.5, 0.5) there, and (0, 0)
in a run's folder. Fields beyond COCO's own are explained in docs/truth.md.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.scenarios.export.labelled_frames import (
    LabelledFrame,
    attributes_of,
    is_row_in_image,
    labelled_frames,
)
from peopleboy.scenarios.export.replay import (
    CORNER_PX,
    OUTSIDE,
    Play,
    from_corner,
    keypoints_from_corner,
)
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.run_folder.atomic_output import write_aside
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import (
    image_file,
    make_image_folders,
    thermal_span_c,
)
from peopleboy.scenarios.run_folder.run_tables import Row
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.sim.geometry.pinhole import CameraGeometry, Matrix, Pinhole
from peopleboy.sim.people.body.skeleton import JOINT_NAMES

_PERSON = 1
_LICENCE: Final = {"id": 1, "name": "MIT", "url": "https://opensource.org/license/mit"}  # the project's
# Pairs of keypoint numbers, from 1, as in COCO.
_SKELETON = (
    (16, 14), (14, 12), (17, 15), (15, 13), (12, 13), (6, 12), (7, 13), (6, 7), (6, 8), (7, 9), (8, 10),
    (9, 11), (2, 3), (1, 2), (1, 3), (2, 4), (3, 5), (4, 6), (5, 7),
)  # fmt: skip


def write_coco(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write runs as one set, or as one set per split; each run is a video.

    Raises:
        BadInput: some runs have splits and others do not.
    """
    for split, own in by_split(runs).items():
        for camera, content in _write_set(own, folder / "images" / (split or ""), play).items():
            path = folder / annotations_file(split, camera)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(content, allow_nan=False), encoding="utf-8")


def annotations_file(split: str | None = None, camera: str = "thermal") -> Path:
    """Return the path of the annotations of a split, or of runs without splits."""
    folder = Path("annotations") / ("" if camera == "thermal" else camera)
    return folder / f"person_keypoints{'' if split is None else f'_{split}'}.json"


def _write_set(runs: Sequence[FinishedRun], folder: Path, play: Play) -> dict[str, dict[str, Any]]:
    """Write the images of runs, and return the annotations of each camera."""
    cameras = {name: _Annotations() for run in runs for name in with_boxes(run.robot.cameras)}
    for video, run in enumerate(runs, start=1):
        make_image_folders(folder / run.name, run.robot.cameras)
        attributes = attributes_of(run)
        for shot in labelled_frames(run, play):
            for place, content in shot.images.items():
                write_aside(folder / run.name / place / image_file(shot.frame), content)
            for name in shot.people:
                cameras[name].add(video, run, name, shot, attributes)
    return {name: _content(runs, name, own) for name, own in cameras.items()}


class _Annotations:
    """Images of one camera, and the people visible in them."""

    def __init__(self) -> None:
        self.images: list[dict[str, Any]] = []
        self.annotations: list[dict[str, Any]] = []

    def add(
        self, video: int, run: FinishedRun, camera: str, shot: LabelledFrame, attributes: Mapping[str, Any]
    ) -> None:
        number = len(self.images) + 1
        about = {"id": number, "video_id": video, "license": _LICENCE["id"]}
        self.images.append(about | image_entry(run, camera, shot, attributes))
        for person in shot.people[camera]:
            if person["visible_px"] > 0:
                own = {"id": len(self.annotations) + 1, "image_id": number}
                self.annotations.append(own | annotation(person, shot.masks[camera], attributes))


def _content(runs: Sequence[FinishedRun], camera: str, own: _Annotations) -> dict[str, Any]:
    videos = [_video(k, run, camera) for k, run in enumerate(runs, start=1) if camera in run.robot.cameras]
    return {
        "info": {"description": "people seen by a simulated robot, with exact truth", "version": "1"},
        "licenses": [_LICENCE],
        "categories": [_category()],
        "videos": videos,
        "images": own.images,
        "annotations": own.annotations,
    }


def annotation(person: Row, instance: NDArray[np.uint8], attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the annotation of a person with at least one visible pixel.

    Args:
        person: row of the ground truth.
        instance: (H, W) id of the person seen at each pixel.
        attributes: constant attributes of each person, by name.
    """
    mask = instance == person["id"]
    height, width = mask.shape
    joints = np.reshape(person["joints_px"], (-1, 2)).tolist()
    keypoints = keypoints_from_corner(joints, person["joint_is_visible"], (width, height))
    return {
        "category_id": _PERSON,
        "iscrowd": 0,
        "bbox": _box(person, "visible_"),
        "area": person["visible_px"],
        "segmentation": _encoded(mask),
        "keypoints": [number for point in keypoints for number in point],
        "num_keypoints": sum(flag != OUTSIDE for _, _, flag in keypoints),
        "whole_bbox": _box(person, "whole_"),
        "body_bbox": _box(person, ""),
        **_truth(person, attributes),
    }


def _box(person: Row, prefix: str) -> list[float] | None:
    left, top, width, height = (person[f"{prefix}{edge}_px"] for edge in ("left", "top", "width", "height"))
    return None if left is None else from_corner((left, top, width, height))


def _encoded(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Encode a mask (H, W) as COCO's compressed run-length text, column by column.

    Runs of 0 and 1 alternate, 0 first. From the fourth run on, the difference to the run before the previous
    one is written, in groups of 5 bits, the lowest first; bit 5 is set if more groups follow.

    Source: `rleToString` in maskApi.c of pycocotools, which gives the same text.
    """
    column = np.pad(mask.ravel(order="F"), (1, 1), constant_values=(False, not mask[-1, -1]))
    ends = np.flatnonzero(column[1:] != column[:-1])
    runs = np.diff(ends, prepend=0).tolist()
    text = ""
    for i, run in enumerate(runs):
        rest = run - runs[i - 2] if i > 2 else run
        is_last = False
        while not is_last:
            group, rest = rest & 31, rest >> 5
            is_last = rest == (-1 if group & 16 else 0)
            text += chr(group + (48 if is_last else 80))
    return {"size": list(mask.shape), "counts": text}


def _truth(person: Row, attributes: Mapping[str, Any]) -> dict[str, Any]:
    same = ("heading_rad", "distance_m", "posture", "is_counted", "visible_fraction", "occluded_fraction")
    return {
        "track_id": person["id"],
        "name": person["name"],
        "position_m": [person["x_m"], person["y_m"]],
        **{key: person[key] for key in same},
        "attributes": attributes[person["name"]],
        "occluder": person["occluder"],
        "hidden_by": dict(person["hidden_by"]),
        "joints_m": np.round(np.reshape(person["joints_m"], (-1, 3)), 4).tolist(),
    }


def image_entry(
    run: FinishedRun, camera: str, shot: LabelledFrame, attributes: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the entry of an image, with time, poses of robot and camera, and hidden people.

    Args:
        run: the run.
        camera: name of the camera.
        shot: the frame.
        attributes: constant attributes of each person, by name.
    """
    geometry, robot = run.robot.cameras[camera].camera, shot.robot
    hidden = [p for p in shot.people[camera] if p["visible_px"] == 0 and is_row_in_image(p)]
    return {
        "file_name": _file_name(run, camera, shot.frame),
        **{
            f"{place}_file_name": _file_name(run, place, shot.frame)
            for place in shot.images
            if place != camera
        },
        "width": geometry.width,
        "height": geometry.height,
        "frame_id": shot.frame,
        "time_s": robot["time_s"],
        "robot": {key: robot[key] for key in ("x_m", "y_m", "heading_rad")},
        "world_from_camera": shot.world_from(geometry.robot_from_camera).tolist(),
        "hidden_people": [{"whole_bbox": _box(p, "whole_"), **_truth(p, attributes)} for p in hidden],
    }


def _file_name(run: FinishedRun, folder: str, frame: int) -> str:
    return f"{run.name}/{folder}/{image_file(frame)}"


def _video(number: int, run: FinishedRun, camera: str) -> dict[str, Any]:
    """Return the video entry of a run for the images of one camera."""
    config = run.robot.cameras[camera]
    return {
        "id": number,
        "name": run.name,
        "scenario": run.scenario.name,
        "seed": run.about.seed,
        "frames": run.frames,
        "rate_hz": run.rate_hz,
        "thermal_span_c": thermal_span_c(config) if isinstance(config, ThermalConfig) else None,
        "cameras": {name: _camera(camera.camera) for name, camera in run.robot.cameras.items()},
    }


def _camera(camera: CameraGeometry) -> dict[str, Any]:
    """Return image size, intrinsics and pose of a camera.

    The matrix of a pinhole camera counts pixels from the corner. A panorama has the parameters of
    `PanoramaCalibration`.
    """
    about: dict[str, Any] = {"width": camera.width, "height": camera.height}
    if isinstance(camera, Pinhole):
        about["intrinsics"] = _intrinsics(camera).tolist()
    calibration = camera.calibration
    if isinstance(calibration, PanoramaCalibration):
        about["panorama"] = asdict(calibration)
    return about | {"robot_from_camera": camera.robot_from_camera.tolist()}


def _intrinsics(camera: Pinhole) -> Matrix:
    intrinsics = camera.intrinsics.copy()
    intrinsics[:2, 2] += CORNER_PX
    return intrinsics


def _category() -> dict[str, Any]:
    return {
        "id": _PERSON,
        "name": "person",
        "supercategory": "person",
        "keypoints": list(JOINT_NAMES),
        "skeleton": [list(pair) for pair in _SKELETON],
    }
