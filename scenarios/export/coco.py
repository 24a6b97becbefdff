"""COCO: images, masks, boxes and keypoints of everybody who can be seen, and the truth of each image.

    annotations/person_keypoints.json
    images/RUN/thermal/000001.png, thermal16/..., colour/...

and of runs of a rendered set, which has splits:

    annotations/person_keypoints_train.json, ..._val.json, ..._test.json
    images/train/RUN/thermal/000001.png, ...

File names in an annotation file begin behind `images`, or behind `images/train`.

COCO counts pixels from the image's corner: the middle of the top-left pixel is (0.5, 0.5) there, and (0, 0)
in a run's folder. Fields beyond COCO's own are explained in docs/truth.md.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.export.by_split import by_split
from peopleboy.scenarios.export.extra import need
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import make_image_folders, write_images
from peopleboy.sim.geometry.pinhole import Camera, Matrix
from peopleboy.sim.people.body.joints import JOINT_NAMES
from peopleboy.sim.truth.truth import Box, PersonTruth

CORNER_PX = 0.5

_PERSON = 1
# Pairs of keypoints, counted from 1, as in COCO.
_SKELETON = (
    (16, 14), (14, 12), (17, 15), (15, 13), (12, 13), (6, 12), (7, 13), (6, 7), (6, 8), (7, 9), (8, 10),
    (9, 11), (2, 3), (1, 2), (1, 3), (2, 4), (3, 5), (4, 6), (5, 7),
)  # fmt: skip


def write_coco(runs: Sequence[FinishedRun], folder: Path, play: Play) -> None:
    """Write runs as one set, or each split of theirs as one; each run is a video.

    Raises:
        BadInput: the runs cannot be sorted by split, or the package that encodes masks is not installed.
    """
    need("pycocotools", "coco")
    for split, own in by_split(runs).items():
        content = _write_set(own, folder / "images" / (split or ""), play)
        path = folder / annotations_file(split)
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(content, allow_nan=False), encoding="utf-8")


def annotations_file(split: str | None = None) -> Path:
    """Where the annotations of a split lie, or those of runs without splits."""
    return Path("annotations") / f"person_keypoints{'' if split is None else f'_{split}'}.json"


def _write_set(runs: Sequence[FinishedRun], folder: Path, play: Play) -> dict[str, Any]:
    """Write the images of runs, and give what is to be said of them."""
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for video, run in enumerate(runs, start=1):
        make_image_folders(folder / run.name)
        for tick in play(run):
            write_images(folder / run.name, tick.frame, tick.observation)
            image = {"id": len(images) + 1, "video_id": video} | _image(run.name, tick)
            images.append(image)
            for person in tick.truth.people:
                if person.visible_px > 0:
                    number = {"id": len(annotations) + 1, "image_id": image["id"]}
                    annotations.append(number | annotation(person, tick.truth.instance))
    return {
        "info": {"description": "people seen by a simulated robot, with exact truth", "version": "1"},
        "licenses": [],
        "categories": [_category()],
        "videos": [_video(number, run) for number, run in enumerate(runs, start=1)],
        "images": images,
        "annotations": annotations,
    }


def annotation(person: PersonTruth, instance: NDArray[np.uint8]) -> dict[str, Any]:
    """Describe somebody of whom at least one pixel is visible.

    Args:
        person: who.
        instance: (H, W) id of the person seen at each pixel.
    """
    mask = instance == person.id
    keypoints = _keypoints(person, mask.shape)
    return {
        "category_id": _PERSON,
        "iscrowd": 0,
        "bbox": from_corner(person.visible_box),
        "area": person.visible_px,
        "segmentation": _encoded(mask),
        "keypoints": [number for point in keypoints for number in point],
        "num_keypoints": sum(point[2] > 0 for point in keypoints),
        "whole_bbox": from_corner(person.whole_box),
        "body_bbox": from_corner(person.box),
        **_truth(person),
    }


def _encoded(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Encode a mask (H, W) by the lengths of its runs, column by column, as text."""
    from pycocotools.mask import encode

    return {"size": list(mask.shape), "counts": encode(np.asfortranarray(mask, np.uint8))["counts"].decode()}


def from_corner(box: Box | None) -> list[float] | None:
    """Count a box's pixels from the image's corner, to a thousandth."""
    if box is None:
        return None
    left, top, width, height = box
    return [round(edge, 3) for edge in (left + CORNER_PX, top + CORNER_PX, width, height)]


def _truth(person: PersonTruth) -> dict[str, Any]:
    return {
        "track_id": person.id,
        "name": person.name,
        "position_m": list(person.position_m),
        "heading_rad": person.heading_rad,
        "distance_m": person.distance_m,
        "posture": person.posture,
        "is_counted": person.is_counted,
        "visible_fraction": person.visible_fraction,
        "occluded_fraction": person.occluded_fraction,
        "occluder": person.occluder,
        "hidden_by": dict(person.hidden_by),
        "joints_m": np.round(person.joints_m, 4).tolist(),
    }


def _keypoints(person: PersonTruth, shape: tuple[int, ...]) -> list[tuple[float, float, int]]:
    """Give u, v and 2 for a joint that is seen, 1 for a hidden one, and zeros for one outside the image."""
    height, width = shape
    found = []
    for (u, v), is_seen in zip(person.joints_px.tolist(), person.joint_is_visible.tolist(), strict=True):
        is_inside = -CORNER_PX < u < width - CORNER_PX and -CORNER_PX < v < height - CORNER_PX
        point = (round(u + CORNER_PX, 3), round(v + CORNER_PX, 3), 2 if is_seen else 1)
        found.append(point if is_inside else (0.0, 0.0, 0))
    return found


def _image(run: str, tick: Tick) -> dict[str, Any]:
    truth = tick.truth
    height, width = tick.observation.thermal.shape
    file = f"{tick.frame:06d}.png"
    hidden = [p for p in truth.people if p.visible_px == 0 and p.is_in_image]
    return {
        "file_name": f"{run}/thermal/{file}",
        "thermal16_file_name": f"{run}/thermal16/{file}",
        "colour_file_name": f"{run}/colour/{file}",
        "width": width,
        "height": height,
        "frame_id": tick.frame,
        "time_s": truth.time_s,
        "robot": {"x_m": truth.robot.x, "y_m": truth.robot.y, "heading_rad": truth.robot.heading},
        "world_from_camera": truth.world_from_camera.tolist(),
        "hidden_people": [{"whole_bbox": from_corner(p.whole_box), **_truth(p)} for p in hidden],
    }


def _video(number: int, run: FinishedRun) -> dict[str, Any]:
    thermal, colour = run.robot.thermal, run.robot.colour
    return {
        "id": number,
        "name": run.name,
        "scenario": run.scenario.name,
        "seed": run.about.seed,
        "frames": run.frames,
        "rate_hz": run.rate_hz,
        "thermal_span_c": [thermal.lowest_c, thermal.highest_c],
        "cameras": {"thermal": _camera(thermal.camera), "colour": _camera(colour.camera)},
    }


def _camera(camera: Camera) -> dict[str, Any]:
    """Give size, matrix with pixels counted from the corner, and where on the robot a camera sits."""
    intrinsics: Matrix = camera.intrinsics.copy()
    intrinsics[:2, 2] += CORNER_PX
    return {
        "width": camera.width,
        "height": camera.height,
        "intrinsics": intrinsics.tolist(),
        "robot_from_camera": camera.robot_from_camera.tolist(),
    }


def _category() -> dict[str, Any]:
    return {
        "id": _PERSON,
        "name": "person",
        "supercategory": "person",
        "keypoints": list(JOINT_NAMES),
        "skeleton": [list(pair) for pair in _SKELETON],
    }
