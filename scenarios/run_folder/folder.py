"""Write a run's folder, file by file, so that an interrupted run is marked as such and stays readable."""

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

import yaml

from peopleboy.bad_input import BadInput
from peopleboy.own_code import OwnCodeFailed, in_one_line, traceback_of
from peopleboy.scenarios.loop.loop import BlindTick, Tick
from peopleboy.scenarios.run_folder.atomic_output import (
    PART,
    check_out,
    hold,
    is_held,
    write_aside,
    writing_to,
)
from peopleboy.scenarios.run_folder.image_files import (
    BackgroundQueue,
    images_to_write,
    make_image_folders,
    mask_file,
    millimetres,
    write_png,
)
from peopleboy.scenarios.run_folder.run_files import truth_files
from peopleboy.scenarios.run_folder.run_tables import (
    ROBOT_TABLE,
    SCANS_FOLDER,
    THINGS_TABLE,
    TRACKS_TABLE,
    Row,
    RunTables,
    recover_tables,
    robot_row,
    scan_rows,
    scan_table,
    thing_rows,
    track_rows,
    truth_rows,
    truth_table,
)
from peopleboy.sim.cameras.camera_config import CameraConfig, DepthConfig, LaserConfig
from peopleboy.sim.cameras.kinds import Stored, with_boxes
from peopleboy.sim.truth.truth import Backgrounds
from peopleboy.tracker.evaluation.mot_files import track_line, truth_line
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.track import confirmed
from peopleboy.user_files import parse_json

_VERSIONED = ("peopleboy", "numpy", "numba", "opencv-python-headless", "pybullet", "scipy")


def further_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the cameras with boxes other than `thermal`, which truth.parquet and truth/gt.txt are about."""
    return tuple(name for name in with_boxes(cameras) if name != "thermal")


def things_camera(cameras: Mapping[str, CameraConfig]) -> str:
    """Return the camera whose image the table of objects refers to: the first depth camera, or `thermal`."""
    return next(iter(depth_cameras(cameras)), "thermal")


def depth_cameras(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the names of the cameras that measure depth."""
    return tuple(name for name, config in cameras.items() if isinstance(config, DepthConfig))


def range_finders(cameras: Mapping[str, CameraConfig]) -> tuple[str, ...]:
    """Return the names of the laser range finders."""
    return tuple(name for name, config in cameras.items() if isinstance(config, LaserConfig))


class BackgroundFiles:
    """Collect what depth cameras see without people, over a run with images.

    Args:
        folder: folder truth/ of the run.
        cameras: cameras of the robot.
    """

    def __init__(self, folder: Path, cameras: Mapping[str, CameraConfig]) -> None:
        self._folder = folder
        self._backgrounds = {name: Backgrounds() for name in depth_cameras(cameras)}

    def update(self, tick: Tick) -> None:
        """Add the ground truth of one tick."""
        for name, backgrounds in self._backgrounds.items():
            if name in tick.truths:
                backgrounds.update(tick.truths[name])

    def save(self) -> None:
        """Write the images."""
        for name, backgrounds in self._backgrounds.items():
            for kind, depth in (("clean", backgrounds.clean), ("ever", backgrounds.ever)):
                if depth is not None:
                    write_png(self._folder / f"{name}_{kind}.png", millimetres(depth))


class RunFolder:
    """Write one run; use it as a context manager.

    The status in `run.json` is "running" from the start, "complete" after `complete`, "cut off" if the block
    is left by an interrupt, and "failed" with the message if it is left by an error. Text files are flushed
    every frame, then images are written, then the frame's record in the log of tables: a frame that has one
    is whole. What a killed process left is completed by `settle_run`.
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
        self._frames = 0
        self._is_complete = False
        _write_json(self.path / "run.json", {"status": "running", **self._about})
        (path / "scenario.yaml").write_text(
            yaml.safe_dump(dict(scenario), sort_keys=False, allow_unicode=True), encoding="utf-8"
        )
        (path / "truth").mkdir()
        if frames:
            make_image_folders(path, cameras)
            for name in with_boxes(cameras):
                mask_file(path, name, 1).parent.mkdir(parents=True)
        self._truths = {
            name: open_text(truth_files(path, name)[0]) for name in (THERMAL, *further_cameras(cameras))
        }
        self._things_camera = things_camera(cameras)
        self._backgrounds = BackgroundFiles(path / "truth", cameras) if frames else None
        self._results = {THERMAL: open_text(path / "tracks.txt")}
        self._events = open_text(path / "events.jsonl")
        hold(self._events)
        self._scanners = range_finders(cameras)
        if self._scanners:
            (path / SCANS_FOLDER).mkdir()
        self._tables = RunTables(path, self._truths, self._scanners)
        self._images = BackgroundQueue()

    def __enter__(self) -> "RunFolder":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._images.close()
        state: Mapping[str, Any] = {"status": "complete" if self._is_complete and kind is None else "cut off"}
        if isinstance(error, Exception):
            state = {"status": "failed", "error": _reported(error)}
        # On a full disk, or in a folder that was deleted, the error that ended the run is the one to report.
        with suppress(OSError) if error is not None else nullcontext(), self._events:
            try:
                self._save()
            finally:
                _write_json(self.path / "run.json", {**state, "frames": self._frames, **self._about})

    def write(self, tick: Tick, events: Sequence[Mapping[str, Any]]) -> None:
        """Write one tick and its events; its images are written in the background, until the next tick.

        Raises:
            BadInput: an image of this tick or of the one before cannot be written.
        """
        self._images.flush()
        self._write_lines(tick, events)
        rows = self._rows(tick)
        if self._backgrounds is None:
            self._commit(rows)
        else:
            self._backgrounds.update(tick)
            images = images_to_write(self.path, tick.frame, tick.observation, self._cameras)
            masks = [
                (mask_file(self.path, name, tick.frame), tick.truths[name].instance)
                for name in self._truths
                if name in tick.truths
            ]
            self._images.add(partial(self._commit, rows, [*images, *masks]))

    def skip(self, tick: Tick | BlindTick) -> None:
        """Write only the robot's row of a tick, whose images and ground truth are not wanted."""
        self._images.flush()
        self._commit({ROBOT_TABLE: [robot_row(tick)]})

    def complete(self, metrics: Mapping[str, Any]) -> None:
        """Write the metrics, and mark the run as complete."""
        _write_json(self.path / "metrics.json", metrics)
        self._is_complete = True

    def complete_sample(self, kept_frames: Sequence[int]) -> None:
        """Mark the run as complete, with images and ground truth of these frames only."""
        self._about["kept_frames"] = list(kept_frames)
        self._is_complete = True

    def flush(self) -> None:
        """Write all files to disk, so that the run can be scored.

        Raises:
            BadInput: an image cannot be written.
        """
        self._images.flush()
        self._save()

    def _commit(self, rows: Mapping[str, list[Row]], images: Sequence[tuple[Path, Stored]] = ()) -> None:
        """Write the images of a frame, and mark it as whole by its rows."""
        for path, image in images:
            write_png(path, image)
        self._tables.write(rows)
        self._frames += 1

    def _save(self) -> None:
        """Complete texts and tables; a second call does nothing."""
        for file in (*self._results.values(), *self._truths.values()):
            file.close()
        if self._backgrounds is not None:
            self._backgrounds.save()
        self._tables.save()

    def _rows(self, tick: Tick) -> dict[str, list[Row]]:
        """Return the rows of a tick by table; cameras that took no image have none."""
        rows = {truth_table(name): truth_rows(tick, name) for name in self._truths if name in tick.truths}
        if tick.truth.things and self._things_camera in tick.truths:
            rows[THINGS_TABLE] = thing_rows(tick, self._things_camera)
        rows |= {scan_table(name): scan_rows(tick, name) for name in self._scanners if name in tick.truths}
        return rows | {TRACKS_TABLE: track_rows(tick), ROBOT_TABLE: [robot_row(tick)]}

    def _write_lines(self, tick: Tick, events: Sequence[Mapping[str, Any]]) -> None:
        """Write boxes by camera, and events; a camera's file of tracks is created with its first box."""
        for camera in {camera for track in tick.tracks for camera in track.boxes} - set(self._results):
            (self.path / "tracks").mkdir(exist_ok=True)
            self._results[camera] = open_text(self.path / "tracks" / f"{camera}.txt")
        lines = [(file, result_lines(tick, camera)) for camera, file in self._results.items()]
        lines += [(file, gt_lines(tick, name)) for name, file in self._truths.items() if name in tick.truths]
        lines.append((self._events, [json.dumps(dict(event)) + "\n" for event in events]))
        for file, added in lines:
            if added:
                file.writelines(added)
                file.flush()


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    write_aside(path, (json.dumps(dict(content), indent=2) + "\n").encode())


def settle_run(folder: Path, about: Mapping[str, Any]) -> dict[str, Any]:
    """Complete the folder of a run whose process was killed, up to its last whole frame.

    Args:
        folder: folder of the run.
        about: contents of run.json, of status "running".

    Returns:
        The new contents of run.json, of status "cut off".

    Raises:
        BadInput: the run goes on, or the folder cannot be written to.
    """
    if is_held(folder / "events.jsonl"):
        raise BadInput(f"{folder}: this run is still going on; wait until it has ended")
    cameras = [
        text.name.removesuffix("gt.txt").removesuffix(".") or THERMAL
        for text in (folder / "truth").glob("*gt.txt")
    ]
    try:
        frames = recover_tables(folder, cameras, _scanners(folder))
        _trim_texts(folder, frames)
        for image in folder.glob("**/*.png"):
            if image.stem.isdecimal() and int(image.stem) > frames:
                image.unlink()
        for part in folder.glob(f"**/*{PART}"):
            part.unlink()
        settled = {**about, "status": "cut off", "frames": frames}
        _write_json(folder / "run.json", settled)
    except OSError as error:
        reason = error.strerror or error
        raise BadInput(f"{folder}: this run was killed, and cannot be completed here: {reason}") from error
    except (ValueError, TypeError, LookupError, AttributeError) as error:
        raise BadInput(f"{folder}: this run was killed, and its files were changed; run it again") from error
    return settled


def _scanners(folder: Path) -> list[str]:
    """Return the range finders of a run that was killed, from the cameras in its scenario.yaml."""
    if not (folder / SCANS_FOLDER).is_dir():
        return []
    cameras = yaml.safe_load((folder / "scenario.yaml").read_text(encoding="utf-8"))["robot"]["cameras"]
    return [name for name, given in cameras.items() if given["kind"] == LaserConfig.kind]


def _whole_lines(path: Path) -> Iterator[str]:
    """Read the lines of a text file, without a last one that is incomplete."""
    with path.open(encoding="utf-8") as file:
        yield from (line for line in file if line.endswith("\n"))


def _trim_texts(folder: Path, frames: int) -> None:
    """Remove incomplete lines, and those of later frames."""
    texts = [folder / "tracks.txt", *(folder / "tracks").glob("*.txt"), *(folder / "truth").glob("*gt.txt")]
    for text in (text for text in texts if text.is_file()):
        kept = (line for line in _whole_lines(text) if int(line.partition(",")[0]) <= frames)
        write_aside(text, "".join(kept).encode())
    events = folder / "events.jsonl"
    if events.is_file():
        kept = (line for line in _whole_lines(events) if parse_json(line)["frame"] <= frames)
        write_aside(events, "".join(kept).encode())


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
        _write_json(path / "run.json", {"status": "running"})


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
