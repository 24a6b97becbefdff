"""Read a finished run from disk: run.json at once, everything else when it is first needed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.validation import validated
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.run_folder.folder import settle_run
from peopleboy.scenarios.run_folder.run_files import RunFiles, read_files
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRUTH
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world_config import WorldConfig
from peopleboy.user_files import is_stream, parse_json, read_json, read_text

_FILES = (
    "scenario.yaml", "truth/gt.txt", "tracks.txt", "truth.parquet", "tracks.parquet", "robot.parquet",
)  # fmt: skip
_TEXTS = ("scenario", "footage", "tracker", "boxes")  # entries of run.json, if given


class ImportedTracks(BaseModel):
    """Entry of run.json about imported tracks."""

    model_config = ConfigDict(strict=True, frozen=True)

    tracks: str
    driven_by: str
    unknown: list[str]


class About(BaseModel):
    """Required entries of run.json for a run of a scenario; there may be others."""

    model_config = ConfigDict(strict=True, frozen=True)

    scenario: str
    seed: Annotated[int, Field(ge=0)]
    tracker: str
    renderer: Literal["raycast", "bullet"]
    rate_hz: Annotated[int, Field(ge=1)]
    frames: Annotated[int, Field(ge=0)]
    versions: dict[str, str]
    images: bool = False
    boxes: Literal["torso", "whole"] = "torso"
    status: Literal["complete", "cut off"] = "complete"
    planned_frames: Annotated[int, Field(ge=1)] | None = None
    behaviour: str | None = None
    adopted: ImportedTracks | None = None
    choice: dict[str, Any] | None = None
    kept_frames: list[int] | None = None
    episode: dict[str, Any] | None = None

    @property
    def ended(self) -> str:
        """How the episode ended that the run repeats; empty if it goes on, or for other runs."""
        return str((self.episode or {}).get("ended") or "")


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """One run of a scenario, complete or cut off.

    All attributes except the first two are read when they are first accessed.

    Attributes:
        folder: folder of the run.
        about: contents of run.json.
        chosen: frames to use instead of all that have images and ground truth; None for all.

    Raises:
        BadInput: a file needed by the accessed attribute is missing or damaged.
    """

    folder: Path
    about: About
    chosen: tuple[int, ...] | None = None

    @property
    def name(self) -> str:
        """Name of the run's folder."""
        return self.folder.resolve().name

    @property
    def title(self) -> str:
        """Scenario and seed."""
        return f"{self.about.scenario}, seed {self.about.seed}"

    @property
    def frames(self) -> int:
        """Number of frames; the first frame is 1."""
        return self.about.frames

    @property
    def is_sampled(self) -> bool:
        """Whether only some frames have images and ground truth."""
        return self.about.kept_frames is not None

    @property
    def kept_frames(self) -> Sequence[int]:
        """The frames to use, ascending: those that have images and ground truth, or some of them."""
        if self.chosen is not None:
            return self.chosen
        return range(1, self.frames + 1) if self.about.kept_frames is None else self.about.kept_frames

    @property
    def incomplete(self) -> str:
        """Note on a run that was cut off; empty for a complete one."""
        return incomplete(self.about.model_dump())

    @property
    def rate_hz(self) -> int:
        """Frames per second."""
        return self.about.rate_hz

    def time_s(self, frame: int) -> float:
        """Return the time of a frame since the start."""
        return (frame - 1) / self.rate_hz

    @cached_property
    def played(self) -> Mapping[str, Any]:
        """Contents of scenario.yaml, the resolved scenario."""
        return read_yaml(self.folder / "scenario.yaml")

    @cached_property
    def scenario(self) -> Scenario:
        """The resolved scenario."""
        return load_scenario(self.folder / "scenario.yaml")

    @cached_property
    def world(self) -> WorldConfig:
        """Settings of the run's world."""
        return self.scenario.world(self.about.seed, self.about.renderer)

    @property
    def robot(self) -> RobotConfig:
        """The robot and its cameras."""
        return self.world.robot

    @cached_property
    def metrics(self) -> Mapping[str, Any]:
        """Contents of metrics.json, by group; a run that was cut off has none."""
        if self.incomplete:
            return {}
        path = self.folder / "metrics.json"
        try:
            data = read_json(path)
        except (OSError, ValueError) as error:
            raise BadInput(f"{path}: cannot be read; give the folder of a finished run") from error
        if not isinstance(data, dict):
            raise BadInput(
                f"{path}: must contain metrics by name, got a {type(data).__name__}; run the scenario again"
            )
        return data

    @cached_property
    def events(self) -> tuple[LogLine, ...]:
        """Contents of events.jsonl."""
        path = self.folder / "events.jsonl"
        try:
            lines = read_text(path).splitlines()
            return tuple(LogLine.from_json(parse_json(line)) for line in lines)
        except (OSError, ValueError, TypeError, AttributeError) as error:
            raise BadInput(f"{path}: cannot be read as an event log; run the scenario again") from error

    def files(self, people: Sequence[str] = TRUTH.names, robot: Sequence[str] = ROBOT.names) -> RunFiles:
        """Read truth and tracks with these columns; they are not cached, so that many runs can be open."""
        return read_files(self.folder, self.frames, people, robot)


def incomplete(about: Mapping[str, Any]) -> str:
    """Return a note on a run that was cut off, from the contents of run.json; empty for a complete one."""
    if about.get("status") == "complete":
        return ""
    planned = about.get("planned_frames")
    return f"incomplete: {about['frames']} {f'of {planned} ' if planned else ''}frames"


def note_on(folder: Path) -> str:
    """Return why a folder is not that of a complete run; empty if it is."""
    try:
        return incomplete(read_run(folder, may_be_sampled=True))
    except BadInput as error:
        return str(error)


def read_run(folder: Path, *, may_be_sampled: bool = False) -> dict[str, Any]:
    """Read run.json of a run that is complete or was cut off; it may also be a run of footage.

    The folder of a run that was killed is completed first, up to its last whole frame.

    Args:
        folder: folder of the run.
        may_be_sampled: whether only some of its frames may have images and ground truth.

    Raises:
        BadInput: there is no run, or it failed, goes on, or was cut off before its first frame; or only some
            of its frames have images and ground truth.
    """
    path = folder / "run.json"
    check_there(folder)
    try:
        about = read_json(path)
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read as a run; give the folder of a finished run") from error
    if isinstance(about, dict) and about.get("status") == "failed":
        failure = about.get("error")
        why = f": {failure['message']}" if isinstance(failure, dict) and "message" in failure else ""
        raise BadInput(f"{path}: this run failed{why}; fix the cause, and run it again")
    if isinstance(about, dict) and about.get("status") == "running":
        about = settle_run(folder, about)
    if not isinstance(about, dict) or about.get("status") not in ("complete", "cut off"):
        raise BadInput(f"{path}: has no status of a run; run it again")
    if about["status"] == "cut off" and about.get("frames") == 0:
        raise BadInput(f"{path}: this run was cut off before its first frame; run it again")
    if "choice" in about:
        _check_sampled(folder, about, may_be_sampled)
    if not isinstance(about.get("frames"), int):
        raise BadInput(f"{path}: frames: must be a whole number, got {about.get('frames')!r}; run it again")
    for key in _TEXTS:
        if not isinstance(about.get(key, ""), str | None):
            raise BadInput(f"{path}: {key}: must be text, got {about[key]!r}; run it again")
    return about


def _check_sampled(folder: Path, about: Mapping[str, Any], may_be_sampled: bool) -> None:
    """Refuse a run with chosen frames only if it was cut off, or if a sequence is needed.

    Raises:
        BadInput: it was, or one is.
    """
    if not may_be_sampled:
        raise BadInput(
            f"{folder}: has chosen frames only, not a sequence; render it without options that choose frames"
        )
    if about["status"] == "cut off":
        raise BadInput(f"{folder}: this run was cut off; repeat its `peopleboy render`")


def open_run(folder: Path, *, may_be_sampled: bool = False) -> FinishedRun:
    """Open a run of a scenario, complete or cut off, by its folder.

    Args:
        folder: folder of the run.
        may_be_sampled: whether only some of its frames may have images and ground truth.

    Raises:
        BadInput: the folder does not contain one.
    """
    data = read_run(folder, may_be_sampled=may_be_sampled)
    if "footage" in data:
        raise BadInput(f"{folder}: is a run of footage; give a run of a scenario")
    try:
        about = validated(About, data)
    except BadInput as error:
        raise BadInput(f"{error}; run the scenario again", file=str(folder / "run.json")) from error
    return FinishedRun(folder, about)


def open_whole_runs(
    folders: Sequence[Path], *, are_named_apart: bool = True, may_be_sampled: bool = False
) -> list[FinishedRun]:
    """Open runs and check that they are complete enough to be replayed.

    Args:
        folders: folders of the runs.
        are_named_apart: whether all names must differ.
        may_be_sampled: whether only some of their frames may have images and ground truth.

    Raises:
        BadInput: a folder does not contain such a run, or two runs have the same name.
    """
    runs = [_open_whole(folder, may_be_sampled) for folder in folders]
    seen: dict[str, Path] = {}
    for run in runs:
        if are_named_apart and run.name in seen:
            raise BadInput(
                f"{run.folder}: has the same name as {seen[run.name]}; leave one out, or rename it"
            )
        seen[run.name] = run.folder
    return runs


def check_there(folder: Path) -> None:
    """Refuse a folder that does not exist, or has pipes or devices, as reading them may never end.

    Raises:
        BadInput: it does not exist, or has one.
    """
    if not folder.is_dir():
        raise BadInput(f"{folder}: folder not found; give the folder of a finished run")
    for path in (*folder.iterdir(), *folder.glob("truth/*"), *folder.glob("tracks/*")):
        if is_stream(path):
            raise BadInput(f"{path}: is a pipe or a device; remove it, or run the scenario again")


def runs_in(folder: Path) -> list[Path]:
    """Return the runs' folders that a folder stands for: itself, or its subfolders with runs.

    Raises:
        BadInput: the folder does not exist.
    """
    check_there(folder)
    inner = sorted(path.parent for path in folder.glob("*/run.json"))
    return inner if inner and not (folder / "run.json").exists() else [folder]


def _open_whole(folder: Path, may_be_sampled: bool) -> FinishedRun:
    read_run(folder, may_be_sampled=may_be_sampled)
    for name in _FILES:
        if not (folder / name).is_file():
            raise BadInput(f"{folder / name}: file not found; only runs of scenarios can be exported")
    run = open_run(folder, may_be_sampled=may_be_sampled)
    _ = run.world
    run.files()
    return run


def cameras_of(folder: Path) -> Mapping[str, CameraConfig]:
    """Return the cameras of a run's robot.

    Raises:
        BadInput: the folder contains no scenario of a run.
    """
    scenario = load_scenario(folder / "scenario.yaml")
    if scenario.episode is None:
        return scenario.robot.config().cameras
    return scenario.world(scenario.seed).robot.cameras
