"""A run's folder: every file that a run leaves, written so that a cut-off run says so and stays readable."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

import yaml

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed, in_one_line, traceback_of
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.atomic_output import check_out, writing_to
from peopleboy.scenarios.run_folder.image_files import (
    BackgroundQueue,
    images_to_write,
    make_image_folders,
    write_png,
)
from peopleboy.scenarios.run_folder.run_tables import (
    ROBOT,
    TRACKS,
    TRUTH,
    Row,
    robot_row,
    track_rows,
    truth_rows,
    write_table,
)
from peopleboy.scenarios.run_folder.truth_files import (
    CameraTruth,
    ThingFiles,
    further_cameras,
    gt_lines,
    open_text,
)
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.tracker.evaluation.mot_files import track_line
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import confirmed

_VERSIONED = ("peopleboy", "numpy", "numba", "opencv-python-headless", "pybullet", "scipy")


class RunFolder:
    """Writes one run; use it as a context manager.

    `run.json` says "running" from the first moment on, "complete" after `complete`, "cut off" when the block
    is left by an interrupt, and "failed" when it is left by an error, with its message. The text files
    grow line by line, the tables are written at the end, also of a run that was cut off or failed.
    """

    def __init__(
        self,
        path: Path,
        scenario: Mapping[str, Any],
        about: Mapping[str, Any],
        cameras: Mapping[str, CameraConfig],
        *,
        frames: bool,
    ) -> None:
        self.path = path
        self._cameras = cameras
        self._about = dict(about) | {"versions": versions()}
        self._writes_frames = frames
        self._truth: list[Row] = []
        self._tracks: list[Row] = []
        self._robot: list[Row] = []
        self._is_complete = False
        self._write_json("run.json", {"status": "running", **self._about})
        (path / "scenario.yaml").write_text(
            yaml.safe_dump(dict(scenario), sort_keys=False, allow_unicode=True), encoding="utf-8"
        )
        (path / "truth").mkdir()
        if frames:
            make_image_folders(path, cameras)
        self._gt = self._open("truth/gt.txt")
        self._things = ThingFiles(path / "truth", cameras, frames=frames)
        self._further = {name: CameraTruth(path / "truth", name) for name in further_cameras(cameras)}
        self._results = {THERMAL: self._open("tracks.txt")}
        self._events = self._open("events.jsonl")
        self._images = BackgroundQueue()

    def __enter__(self) -> RunFolder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._images.close()
        for file in self._texts():
            file.close()
        for camera in self._further.values():
            camera.close()
        if not self._is_complete:
            self._write_tables()
        state: Mapping[str, Any] = {"status": "complete" if self._is_complete and kind is None else "cut off"}
        if isinstance(error, Exception):
            state = {"status": "failed", "error": _reported(error)}
        self._write_json("run.json", {**state, "frames": len(self._robot), **self._about})

    def write(self, tick: Tick, events: Sequence[Mapping[str, Any]]) -> None:
        """Write one tick and what happened at it; images are written behind the run, in order.

        Raises:
            BadInput: an image, of this tick or an earlier one, cannot be written.
        """
        self._truth += truth_rows(tick)
        self._tracks += track_rows(tick)
        self._robot.append(robot_row(tick))
        self._gt.writelines(gt_lines(tick))
        for camera in self._further.values():
            camera.write(tick)
        self._things.write(tick)
        self._write_boxes(tick)
        self._events.writelines(json.dumps(dict(event)) + "\n" for event in events)
        if self._writes_frames:
            for path, image in images_to_write(self.path, tick.frame, tick.observation, self._cameras):
                self._images.add(partial(write_png, path, image))

    def complete(self, metrics: Mapping[str, Any]) -> None:
        """Write the metrics; the run is whole."""
        self._write_json("metrics.json", metrics)
        self._is_complete = True

    def flush(self) -> None:
        """Bring all files to disk, so that the run can be scored.

        Raises:
            BadInput: an image cannot be written.
        """
        self._images.flush()
        self._write_tables()
        for file in self._texts():
            file.flush()
        for camera in self._further.values():
            camera.flush()

    def _texts(self) -> tuple[TextIO, ...]:
        return self._gt, self._events, *self._results.values()

    def _write_boxes(self, tick: Tick) -> None:
        """Write the boxes that the tracker gives, by camera; a camera's file begins with its first box."""
        for camera in {camera for track in tick.tracks for camera in track.boxes} - set(self._results):
            (self.path / "tracks").mkdir(exist_ok=True)
            self._results[camera] = self._open(f"tracks/{camera}.txt")
        for camera, file in self._results.items():
            file.writelines(result_lines(tick, camera))

    def _write_tables(self) -> None:
        write_table(self.path / "truth.parquet", self._truth, TRUTH)
        write_table(self.path / "tracks.parquet", self._tracks, TRACKS)
        write_table(self.path / "robot.parquet", self._robot, ROBOT)
        self._things.flush()

    def _open(self, name: str) -> TextIO:
        return open_text(self.path / name)

    def _write_json(self, name: str, content: Mapping[str, Any]) -> None:
        (self.path / name).write_text(json.dumps(dict(content), indent=2) + "\n", encoding="utf-8")


def _reported(error: Exception) -> dict[str, str]:
    """Describe what ended a run; bad input is explained in one line, and has no traceback."""
    if isinstance(error, BadInput):
        return {"message": str(error)}
    message = str(error) if isinstance(error, OwnCodeFailed) else in_one_line(error)
    return {"message": message, "traceback": traceback_of(error)}


def versions() -> dict[str, str]:
    """Return the versions of the packages on which the bytes of a run depend, of those that are installed."""
    found = {}
    for name in _VERSIONED:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def claim_folder(path: Path, *, overwrite: bool) -> None:
    """Make the folder of a new run.

    Raises:
        BadInput: there is something at this path that must not be replaced, or the folder cannot be written.
    """
    with writing_to(path):
        check_out(path, "run", overwrite=overwrite)
        if path.exists() and any(path.iterdir()):
            shutil.rmtree(path)
        path.mkdir(parents=True, exist_ok=True)
        (path / "run.json").touch()


def result_lines(tick: Tick, camera: str = THERMAL) -> list[str]:
    """MOTChallenge results in the image of a camera: one line per confirmed track."""
    return [
        track_line(tick.frame, track.id, box, track.confidence)
        for track, box in confirmed(tick.tracks, camera)
    ]
