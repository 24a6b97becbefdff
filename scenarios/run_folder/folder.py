"""Write a run's folder, file by file, so that an interrupted run is marked as such and stays readable."""

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
    millimetres,
    write_png,
)
from peopleboy.scenarios.run_folder.run_files import truth_files
from peopleboy.scenarios.run_folder.run_tables import (
    ROBOT,
    THINGS,
    TRACKS,
    TRUTH,
    Row,
    robot_row,
    thing_rows,
    track_rows,
    truth_rows,
    write_table,
)
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig
from peopleboy.sim.cameras.kinds import with_boxes
from peopleboy.sim.truth.truth import Backgrounds
from peopleboy.tracker.evaluation.mot_files import track_line, truth_line
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import confirmed

_VERSIONED = ("peopleboy", "numpy", "numba", "opencv-python-headless", "pybullet", "scipy")


def further_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the cameras with boxes other than `thermal`, which truth.parquet and truth/gt.txt are about."""
    return tuple(name for name in with_boxes(cameras) if name != "thermal")


class CameraTruth:
    """Write the ground truth of one camera, for the frames in which it took an image.

    Args:
        folder: folder of the run.
        camera: name of the camera.
    """

    def __init__(self, folder: Path, camera: str) -> None:
        text, self._table = truth_files(folder, camera)
        self.lines = open_text(text)
        self._camera = camera
        self._rows: list[Row] = []

    def write(self, tick: Tick) -> None:
        """Write the ground truth of one tick."""
        if self._camera in tick.truths:
            self._rows += truth_rows(tick, self._camera)
            self.lines.writelines(gt_lines(tick, self._camera))

    def write_table(self) -> None:
        """Write the table to disk."""
        write_table(self._table, self._rows, TRUTH)


def things_camera(cameras: Mapping[str, CameraConfig]) -> str:
    """Return the camera whose image the table of objects refers to: the first depth camera, or `thermal`."""
    return next(iter(depth_cameras(cameras)), "thermal")


def depth_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the names of the cameras that measure depth."""
    return tuple(name for name, config in cameras.items() if isinstance(config, DepthConfig))


class ThingFiles:
    """Write the ground truth of objects, for a run in which some are moved.

    Args:
        folder: folder truth/ of the run.
        cameras: cameras of the robot.
        frames: whether to write images, and with them the backgrounds of depth cameras.
    """

    def __init__(self, folder: Path, cameras: Mapping[str, CameraConfig], *, frames: bool) -> None:
        self._folder = folder
        self._camera = things_camera(cameras)
        self._rows: list[Row] = []
        self._has_things = False
        self._backgrounds = {name: Backgrounds() for name in depth_cameras(cameras)} if frames else {}

    def write(self, tick: Tick) -> None:
        """Collect the ground truth of one tick."""
        if tick.truth.things and self._camera in tick.truths:
            self._has_things = True
            self._rows += thing_rows(tick, self._camera)
        for name, backgrounds in self._backgrounds.items():
            if name in tick.truths:
                backgrounds.update(tick.truths[name])

    def flush(self) -> None:
        """Write everything to disk."""
        if self._has_things:
            write_table(self._folder / "things.parquet", self._rows, THINGS)
        for name, backgrounds in self._backgrounds.items():
            for kind, depth in (("clean", backgrounds.clean), ("ever", backgrounds.ever)):
                if depth is not None:
                    write_png(self._folder / f"{name}_{kind}.png", millimetres(depth))


class RunFolder:
    """Write one run; use it as a context manager.

    The status in `run.json` is "running" from the start, "complete" after `complete`, "cut off" if the block
    is left by an interrupt, and "failed" with the message if it is left by an error. Text files grow line by
    line; tables are written at the end, including those of a run that was cut off or failed.
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
        self._truths = [CameraTruth(path, name) for name in (THERMAL, *further_cameras(cameras))]
        self._things = ThingFiles(path / "truth", cameras, frames=frames)
        self._results = {THERMAL: open_text(path / "tracks.txt")}
        self._events = open_text(path / "events.jsonl")
        self._images = BackgroundQueue()

    def __enter__(self) -> "RunFolder":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._images.close()
        for file in self._texts():
            file.close()
        if not self._is_complete:
            self._write_tables()
        state: Mapping[str, Any] = {"status": "complete" if self._is_complete and kind is None else "cut off"}
        if isinstance(error, Exception):
            state = {"status": "failed", "error": _reported(error)}
        self._write_json("run.json", {**state, "frames": len(self._robot), **self._about})

    def write(self, tick: Tick, events: Sequence[Mapping[str, Any]]) -> None:
        """Write one tick and its events; images are written in the background, in order.

        Raises:
            BadInput: an image of this tick or of an earlier one cannot be written.
        """
        self._tracks += track_rows(tick)
        self._robot.append(robot_row(tick))
        for truth in self._truths:
            truth.write(tick)
        self._things.write(tick)
        self._write_boxes(tick)
        self._events.writelines(json.dumps(dict(event)) + "\n" for event in events)
        if self._writes_frames:
            for path, image in images_to_write(self.path, tick.frame, tick.observation, self._cameras):
                self._images.add(partial(write_png, path, image))

    def complete(self, metrics: Mapping[str, Any]) -> None:
        """Write the metrics, and mark the run as complete."""
        self._write_json("metrics.json", metrics)
        self._is_complete = True

    def flush(self) -> None:
        """Write all files to disk, so that the run can be scored.

        Raises:
            BadInput: an image cannot be written.
        """
        self._images.flush()
        self._write_tables()
        for file in self._texts():
            file.flush()

    def _texts(self) -> tuple[TextIO, ...]:
        return self._events, *self._results.values(), *(truth.lines for truth in self._truths)

    def _write_boxes(self, tick: Tick) -> None:
        """Write the tracker's boxes by camera; a camera's file is created with its first box."""
        for camera in {camera for track in tick.tracks for camera in track.boxes} - set(self._results):
            (self.path / "tracks").mkdir(exist_ok=True)
            self._results[camera] = open_text(self.path / "tracks" / f"{camera}.txt")
        for camera, file in self._results.items():
            file.writelines(result_lines(tick, camera))

    def _write_tables(self) -> None:
        for truth in self._truths:
            truth.write_table()
        write_table(self.path / "tracks.parquet", self._tracks, TRACKS)
        write_table(self.path / "robot.parquet", self._robot, ROBOT)
        self._things.flush()

    def _write_json(self, name: str, content: Mapping[str, Any]) -> None:
        (self.path / name).write_text(json.dumps(dict(content), indent=2) + "\n", encoding="utf-8")


def _reported(error: Exception) -> dict[str, str]:
    """Describe the error that ended a run; bad input has one line and no traceback."""
    if isinstance(error, BadInput):
        return {"message": str(error)}
    message = str(error) if isinstance(error, OwnCodeFailed) else in_one_line(error)
    return {"message": message, "traceback": traceback_of(error)}


def versions() -> dict[str, str]:
    """Return the versions of the installed packages that the output of a run depends on."""
    found = {}
    for name in _VERSIONED:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def claim_folder(path: Path, *, overwrite: bool) -> None:
    """Create the folder of a new run.

    Raises:
        BadInput: the path exists and must not be replaced, or the folder cannot be written to.
    """
    with writing_to(path):
        check_out(path, "run", overwrite=overwrite)
        if path.exists() and any(path.iterdir()):
            shutil.rmtree(path)
        path.mkdir(parents=True, exist_ok=True)
        (path / "run.json").touch()


def result_lines(tick: Tick, camera: str = THERMAL) -> list[str]:
    """Return MOTChallenge results in the image of a camera: one line per confirmed track."""
    return [
        track_line(tick.frame, track.id, box, track.confidence)
        for track, box in confirmed(tick.tracks, camera)
    ]


def gt_lines(tick: Tick, camera: str = "thermal") -> list[str]:
    """Return MOTChallenge ground truth of a camera: one line per person whose silhouette is in the image."""
    return [
        truth_line(tick.frame, person.id, person.box, person.is_counted, person.visible_fraction)
        for person in tick.truths[camera].people
        if person.box is not None and person.is_in_image
    ]


def open_text(path: Path) -> TextIO:
    """Open a text file for writing lines."""
    return path.open("w", encoding="utf-8", newline="\n")
