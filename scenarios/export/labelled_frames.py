"""Frames of a run with images, masks and ground truth as exported: kept files, or else rendered again."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.replay import Play, one_camera
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import image_file, mask_file, png_bytes
from peopleboy.scenarios.run_folder.run_files import read_table, truth_files
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRUTH, Row, robot_row, truth_rows
from peopleboy.sim.cameras.kinds import image_folders, with_boxes
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.observation import OnDemand
from peopleboy.sim.people.appearance.finisher import appearance_stream, draw_bearing

_BORDER = "border"
_POSE = ("frame", "time_s", "x_m", "y_m", "heading_rad")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LabelledFrame:
    """One frame of a run.

    Attributes:
        frame: 1, 2, ...
        robot: row of robot.parquet; at least time and pose.
        people: rows of the ground truth, by camera that took an image.
        masks: (H, W) id of the person at each pixel, by camera.
        images: contents of the PNG files, by folder of images.
    """

    frame: int
    robot: Row
    people: Mapping[str, Sequence[Row]]
    masks: Mapping[str, NDArray[np.uint8]]
    images: Mapping[str, bytes]

    def world_from(self, robot_from_camera: Matrix) -> Matrix:
        """Return the (4, 4) pose of a camera with this mounting pose."""
        cos, sin = np.cos(self.robot["heading_rad"]), np.sin(self.robot["heading_rad"])
        pose = np.eye(4)
        pose[:2, :2] = (cos, -sin), (sin, cos)
        pose[:2, 3] = self.robot["x_m"], self.robot["y_m"]
        return np.asarray(pose @ robot_from_camera)


def is_row_in_image(row: Row) -> bool:
    """Return whether part of a person's silhouette is inside the image, ignoring occlusion."""
    return bool(row["whole_px"]) and dict(row["hidden_by"]).get(_BORDER, 0.0) < 1.0


def labelled_frames(run: FinishedRun, play: Play) -> Iterator[LabelledFrame]:
    """Yield the frames of a run; they are rendered again unless the run has all their images and masks.

    Raises:
        BadInput: a file is damaged, or the replay differs from the run.
    """
    return _kept_shots(run) if _has_files(run) else _played_shots(run, play)


def _played_shots(run: FinishedRun, play: Play) -> Iterator[LabelledFrame]:
    cameras = run.robot.cameras
    for tick in play(run):
        seen = [name for name in with_boxes(cameras) if name in tick.truths]
        images = tick.observation.images
        yield LabelledFrame(
            frame=tick.frame,
            robot=robot_row(tick),
            people={name: truth_rows(tick, name) for name in seen},
            masks={name: tick.truths[name].instance for name in seen},
            images={
                folder: png_bytes(layer.encode(images[name]))
                for folder, name, layer in image_folders(cameras)
                if name in images
            },
        )


def _due(run: FinishedRun) -> dict[str, set[int]]:
    """Return the frames in which each camera took an image."""
    return {name: set(one_camera(run, name).frames) for name in run.robot.cameras}


def _files(run: FinishedRun) -> Iterator[tuple[str, str]]:
    """Yield each folder of images with its camera."""
    for name, config in run.robot.cameras.items():
        for folder, _, _ in image_folders({name: config}):
            yield folder, name


def _has_files(run: FinishedRun) -> bool:
    """Return whether a run has all images and masks of its frames."""
    due = _due(run)
    needed = [run.folder / folder / image_file(n) for folder, name in _files(run) for n in due[name]]
    needed += [mask_file(run.folder, name, n) for name in with_boxes(run.robot.cameras) for n in due[name]]
    return all(path.is_file() for path in needed)


def _kept_shots(run: FinishedRun) -> Iterator[LabelledFrame]:
    due, files, boxed = _due(run), list(_files(run)), with_boxes(run.robot.cameras)
    robot = read_table(run.folder / "robot.parquet", ROBOT, _POSE).to_pylist()
    people = {name: _rows_by_frame(run, name) for name in boxed}
    for frame in run.kept_frames:
        seen = [name for name in boxed if frame in due[name]]
        folders = [folder for folder, name in files if frame in due[name]]
        yield LabelledFrame(
            frame=frame,
            robot=robot[frame - 1],
            people={name: people[name][frame] for name in seen},
            masks=OnDemand(seen, partial(_mask, run.folder, frame)),
            images=OnDemand(folders, partial(_content, run.folder, frame)),
        )


def _rows_by_frame(run: FinishedRun, camera: str) -> dict[int, list[Row]]:
    rows: dict[int, list[Row]] = defaultdict(list)
    for row in read_table(truth_files(run.folder, camera)[1], TRUTH, TRUTH.names).to_pylist():
        rows[row["frame"]].append(row)
    return rows


def _mask(folder: Path, frame: int, camera: str) -> NDArray[np.uint8]:
    path = mask_file(folder, camera, frame)
    mask = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if mask is None or mask.dtype != np.uint8 or mask.ndim != 2:
        raise BadInput(f"{path}: cannot be read as a mask; run the scenario again")
    return np.asarray(mask, np.uint8)


def _content(folder: Path, frame: int, images: str) -> bytes:
    return (folder / images / image_file(frame)).read_bytes()


def attributes_of(run: FinishedRun) -> dict[str, dict[str, Any]]:
    """Return the constant attributes of each person of a run by name: body, gait, items and clothes."""
    found: dict[str, dict[str, Any]] = {}
    for person in run.world.people:
        clothes = {name: worn for name, worn in asdict(person.clothes).items() if worn is not None}
        same = ("sex", "age", "build", "height_m", "gait", "arms", "bag", "equipment")
        about = {name: getattr(person, name) for name in same}
        found[person.name] = about | clothes
        if run.world.detail == "full":
            outfit, _ = draw_bearing(person, appearance_stream(run.about.seed, person.name))
            found[person.name] |= {
                "coat": outfit.coat, "headgear": outfit.headgear, "carried": outfit.carried,
            }  # fmt: skip
    return found
