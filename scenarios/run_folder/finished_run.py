"""A finished run as it lies on disk: what run.json says at once, all else when it is asked for."""

import json
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
from peopleboy.scenarios.run_folder.run_files import RunFiles, read_files
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRUTH
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.world_config import WorldConfig

_FILES = (
    "scenario.yaml", "truth/gt.txt", "tracks.txt", "truth.parquet", "tracks.parquet", "robot.parquet",
)  # fmt: skip


class Adopted(BaseModel):
    """What run.json says of tracks that were made elsewhere."""

    model_config = ConfigDict(strict=True, frozen=True)

    tracks: str
    driven_by: str
    unknown: list[str]


class About(BaseModel):
    """What run.json must say of a run of a scenario; it may say more."""

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
    behaviour: str | None = None
    adopted: Adopted | None = None


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """One complete run of a scenario.

    Each attribute but the first two is read when it is first asked for.

    Attributes:
        folder: where it lies.
        about: what run.json says.

    Raises:
        BadInput: in what is asked for, a file is missing or spoilt.
    """

    folder: Path
    about: About

    @property
    def name(self) -> str:
        """Its folder's name."""
        return self.folder.resolve().name

    @property
    def title(self) -> str:
        """Scenario and seed."""
        return f"{self.about.scenario}, seed {self.about.seed}"

    @property
    def frames(self) -> int:
        """How many there are; the first is 1."""
        return self.about.frames

    @property
    def rate_hz(self) -> int:
        """Frames a second."""
        return self.about.rate_hz

    def time_s(self, frame: int) -> float:
        """When a frame was taken, from the start."""
        return (frame - 1) / self.rate_hz

    @cached_property
    def played(self) -> Mapping[str, Any]:
        """What scenario.yaml says, everything drawn."""
        return read_yaml(self.folder / "scenario.yaml")

    @cached_property
    def scenario(self) -> Scenario:
        """The same as a scenario."""
        return load_scenario(self.folder / "scenario.yaml")

    @cached_property
    def world(self) -> WorldConfig:
        """Settings of its world."""
        return self.scenario.world(self.about.seed, self.about.renderer)

    @property
    def robot(self) -> RobotConfig:
        """The robot and its cameras."""
        return self.world.robot

    @cached_property
    def metrics(self) -> Mapping[str, Any]:
        """What metrics.json says, by group."""
        path = self.folder / "metrics.json"
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise BadInput(f"{path}: cannot be read; give the folder of a finished run") from error
        if not isinstance(data, dict):
            raise BadInput(
                f"{path}: holds a {type(data).__name__}, not figures by name; run the scenario again"
            )
        return data

    @cached_property
    def events(self) -> tuple[LogLine, ...]:
        """What events.jsonl says."""
        path = self.folder / "events.jsonl"
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
            return tuple(LogLine.from_json(json.loads(line)) for line in lines)
        except (OSError, ValueError, TypeError, AttributeError) as error:
            raise BadInput(f"{path}: cannot be read as an event log; run the scenario again") from error

    def files(self, people: Sequence[str] = TRUTH.names, robot: Sequence[str] = ROBOT.names) -> RunFiles:
        """Read truth and tracks, with these columns; they are not kept, so that many runs can be open."""
        return read_files(self.folder, self.frames, people, robot)


def read_run(folder: Path) -> dict[str, Any]:
    """Read what run.json says of a complete run, of footage too.

    Raises:
        BadInput: there is no run, or it is not complete.
    """
    path = folder / "run.json"
    check_there(folder)
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read as a run; give the folder of a finished run") from error
    if isinstance(about, dict) and about.get("status") == "failed":
        failure = about.get("error")
        why = f": {failure['message']}" if isinstance(failure, dict) and "message" in failure else ""
        raise BadInput(f"{path}: this run failed{why}; mend that, and run it again")
    if not isinstance(about, dict) or about.get("status") != "complete":
        raise BadInput(
            f"{path}: this run was cut off; run it again, or score its files with --truth and --tracks"
        )
    if not isinstance(about.get("frames"), int):
        raise BadInput(f"{path}: frames: must be a whole number, got {about.get('frames')!r}; run it again")
    return about


def open_run(folder: Path) -> FinishedRun:
    """Open a complete run of a scenario by its folder.

    Raises:
        BadInput: there is none.
    """
    data = read_run(folder)
    if "footage" in data:
        raise BadInput(f"{folder}: is a run of footage; only runs of scenarios can be looked into so")
    try:
        about = validated(About, data)
    except BadInput as error:
        raise BadInput(f"{error}; run the scenario again", file=str(folder / "run.json")) from error
    return FinishedRun(folder, about)


def open_whole_runs(folders: Sequence[Path], *, are_named_apart: bool = True) -> list[FinishedRun]:
    """Open runs of which all is there that is needed to play them again, and look at all of it once.

    Args:
        folders: theirs.
        are_named_apart: whether each must have a name of its own.

    Raises:
        BadInput: there is no such run in a folder, or two have the same name.
    """
    runs = [_open_whole(folder) for folder in folders]
    seen: dict[str, Path] = {}
    for run in runs:
        if are_named_apart and run.name in seen:
            raise BadInput(
                f"{run.folder}: {seen[run.name]} is called {run.name} too; leave one out, or rename it"
            )
        seen[run.name] = run.folder
    return runs


def check_there(folder: Path) -> None:
    """Refuse a folder that there is not.

    Raises:
        BadInput: it is one.
    """
    if not folder.is_dir():
        raise BadInput(f"{folder}: there is no such folder; give the folder of a finished run")


def runs_in(folder: Path) -> list[Path]:
    """List the folders of runs that a folder stands for: itself, or those in it.

    Raises:
        BadInput: there is no such folder.
    """
    check_there(folder)
    inner = sorted(path.parent for path in folder.glob("*/run.json"))
    return inner if inner and not (folder / "run.json").exists() else [folder]


def _open_whole(folder: Path) -> FinishedRun:
    read_run(folder)
    for name in _FILES:
        if not (folder / name).is_file():
            raise BadInput(
                f"{folder / name}: there is no such file; only whole runs of scenarios can be exported"
            )
    run = open_run(folder)
    _ = run.world
    run.files()
    return run


def cameras_of(folder: Path) -> Mapping[str, CameraConfig]:
    """Read which cameras the robot of a run had.

    Raises:
        BadInput: there is no scenario of a run.
    """
    return load_scenario(folder / "scenario.yaml").robot.config().cameras
