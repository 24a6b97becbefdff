"""A finished run as it lies on disk: its scenario, and its tables by frame."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.run_folder.explained import read_explanation
from peopleboy.scenarios.run_folder.run_files import RunFiles, read_about, read_files, read_run
from peopleboy.scenarios.run_folder.tables import Row, track_of
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.track import Track

_FILES = (
    "scenario.yaml", "truth/gt.txt", "tracks.txt", "truth.parquet", "tracks.parquet", "robot.parquet",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class FinishedRun:
    """One complete run.

    Attributes:
        folder: where it lies.
        scenario: what was played, everything drawn.
        seed: of the run.
        tracker: its name.
        frames: how many.
        rate_hz: frames a second.
        versions: packages that made it, by name.
        world: settings of its world.
    """

    folder: Path
    scenario: Scenario
    seed: int
    tracker: str
    frames: int
    rate_hz: int
    versions: dict[str, str]
    world: WorldConfig

    @property
    def name(self) -> str:
        """Its folder's name."""
        return self.folder.resolve().name

    @property
    def robot(self) -> RobotConfig:
        """The robot and its cameras."""
        return self.world.robot

    def truth_rows(self) -> dict[int, list[Row]]:
        """Give the rows of truth.parquet, by frame."""
        return _by_frame(self._files().people.to_pylist())

    def robot_rows(self) -> list[Row]:
        """Give the rows of robot.parquet, one a frame."""
        rows: list[Row] = self._files().robot.to_pylist()
        return rows

    def tracks(self) -> dict[int, list[Track]]:
        """Give what the tracker said, by frame, tentative tracks too."""
        rows = _by_frame(self._files().beliefs.to_pylist())
        return defaultdict(list, {frame: [track_of(row) for row in here] for frame, here in rows.items()})

    def explanations(self) -> dict[int, object]:
        """Give what the tracker explained, by frame, as far as the tables hold it."""
        rows = _by_frame(self._files().beliefs.to_pylist())
        return defaultdict(
            lambda: None, {frame: read_explanation(self.tracker, here) for frame, here in rows.items()}
        )

    def _files(self) -> RunFiles:
        return read_files(self.folder, self.frames)


def open_runs(folders: Sequence[Path]) -> list[FinishedRun]:
    """Open complete runs by their folders.

    Raises:
        BadInput: there is no complete run in a folder, or two have the same name.
    """
    runs = [open_run(folder) for folder in folders]
    seen: dict[str, Path] = {}
    for run in runs:
        if run.name in seen:
            raise BadInput(
                f"{run.folder}: {seen[run.name]} is called {run.name} too; leave one out, or rename it"
            )
        seen[run.name] = run.folder
    return runs


def open_run(folder: Path) -> FinishedRun:
    """Open a complete run by its folder.

    Raises:
        BadInput: there is none.
    """
    read_run(folder)
    for name in _FILES:
        if not (folder / name).is_file():
            raise BadInput(
                f"{folder / name}: there is no such file; only whole runs of scenarios can be exported"
            )
    about = read_about(folder)
    scenario = load_scenario(folder / "scenario.yaml")
    read_files(folder, about.frames)
    return FinishedRun(
        folder=folder,
        scenario=scenario,
        seed=about.seed,
        tracker=about.tracker,
        frames=about.frames,
        rate_hz=about.rate_hz,
        versions=about.versions,
        world=scenario.world(about.seed, about.renderer),
    )


def _by_frame(rows: Sequence[Row]) -> dict[int, list[Row]]:
    found: dict[int, list[Row]] = defaultdict(list)
    for row in rows:
        found[row["frame"]].append(row)
    return found
