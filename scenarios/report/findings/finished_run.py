"""A finished run, read back from its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.run_events import LogLine
from peopleboy.scenarios.run_folder.run_files import read_about, read_files
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

_BOX = ("left_px", "top_px", "width_px", "height_px")
_PEOPLE = (
    *("frame", "id", "name", "x_m", "y_m", "distance_m", "is_counted", *_BOX, "whole_px"),
    *("visible_fraction", "occluded_fraction", "occluder", "hidden_by"),
)
_ROBOT = ("frame", "x_m", "y_m", "mode")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FinishedRun:
    """All that a page needs of a run but its images.

    Attributes:
        folder: where it lies.
        about: what run.json says.
        played: what scenario.yaml says; nothing if it cannot be read.
        scenario: the same as a scenario; None if it cannot be loaded.
        fault: why it cannot, in a line; empty if it can.
        metrics: what metrics.json says, by group.
        events: what events.jsonl says.
        truth: the people of the sequence.
        tracks: what the tracker claimed.
        people: what a page needs of `peopleboy.scenarios.run_folder.tables.TRUTH`.
        beliefs: of `peopleboy.scenarios.run_folder.tables.TRACKS`.
        robot: of `peopleboy.scenarios.run_folder.tables.ROBOT`.
    """

    folder: Path
    about: Mapping[str, Any]
    played: Mapping[str, Any]
    scenario: Scenario | None
    fault: str
    metrics: Mapping[str, Any]
    events: tuple[LogLine, ...]
    truth: TrueBoxes
    tracks: TrackBoxes
    people: pa.Table
    beliefs: pa.Table
    robot: pa.Table

    @property
    def frames(self) -> int:
        """How many there are; the first is 1."""
        return int(self.about["frames"])

    @property
    def rate_hz(self) -> float:
        """Frames a second."""
        return float(self.about["rate_hz"])

    @property
    def duration_s(self) -> float:
        """From the first frame to the end of the last."""
        return self.frames / self.rate_hz

    @property
    def name(self) -> str:
        """Scenario and seed."""
        return f"{self.about['scenario']}, seed {self.about['seed']}"

    def time_s(self, frame: int) -> float:
        """When a frame was taken, from the start."""
        return (frame - 1) / self.rate_hz


def read_finished(folder: Path) -> FinishedRun:
    """Read a run's folder.

    Raises:
        BadInput: it holds no run, or one that was cut off, or a file of it is missing or spoilt, other than
            the scenario's, which only plans and images need.
    """
    about = read_about(folder)
    files = read_files(folder, about.frames, people=_PEOPLE, robot=_ROBOT)
    played, scenario, fault = _read_scenario(folder / "scenario.yaml")
    return FinishedRun(
        folder=folder,
        about=about.model_dump(),
        played=played,
        scenario=scenario,
        fault=fault,
        metrics=_read_json(folder / "metrics.json"),
        events=_read_events(folder / "events.jsonl"),
        truth=files.truth,
        tracks=files.tracks,
        people=files.people,
        beliefs=files.beliefs,
        robot=files.robot,
    )


def _read_scenario(path: Path) -> tuple[Mapping[str, Any], Scenario | None, str]:
    played: Mapping[str, Any] = {}
    try:
        played = read_yaml(path)
        return played, load_scenario(path), ""
    except BadInput as error:
        return played, None, str(error)


def _read_json(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: cannot be read; give the folder of a finished run") from error
    if not isinstance(data, dict):
        raise BadInput(f"{path}: holds a {type(data).__name__}, not figures by name; run the scenario again")
    return data


def _read_events(path: Path) -> tuple[LogLine, ...]:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        return tuple(LogLine(**json.loads(line)) for line in lines)
    except (OSError, ValueError, TypeError) as error:
        raise BadInput(f"{path}: cannot be read as an event log; run the scenario again") from error
