"""What a finished run of a scenario left: its files, held against what they must be, and against each other.

A run of another version, or one whose files were changed since, is refused here with one line.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bad_input import BadInput
from scenarios.evaluate_runs import check_end, read_run
from scenarios.explain import explain
from scenarios.tables import MAY_BE_EMPTY, ROBOT, TRACKS, TRUTH
from tracker.evaluation.mot_files import read_tracks, read_truth
from tracker.evaluation.sequence import Rows, Tracks, Truth
from tracker.track import Status

_AGAIN = "run the scenario again"


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunFiles:
    """The tables of a run.

    Attributes:
        truth, tracks: truth/gt.txt and tracks.txt.
        people, beliefs, robot: truth.parquet, tracks.parquet, robot.parquet.
    """

    truth: Truth
    tracks: Tracks
    people: pa.Table
    beliefs: pa.Table
    robot: pa.Table


def read_about(folder: Path) -> About:
    """Read what run.json says of a complete run of a scenario.

    Raises:
        BadInput: there is no such run.
    """
    data = read_run(folder)
    if "footage" in data:
        raise BadInput(f"{folder}: is a run of footage; only runs of scenarios can be looked into so")
    try:
        return About.model_validate(data)
    except ValidationError as error:
        raise BadInput(f"{folder / 'run.json'}: {explain(error, About)}; {_AGAIN}") from error


def read_files(
    folder: Path,
    frames: int,
    people: Sequence[str] = TRUTH.names,
    robot: Sequence[str] = ROBOT.names,
) -> RunFiles:
    """Read the tables of a run that has so many frames.

    Args:
        folder: of the run.
        frames: how many.
        people: the columns wanted of truth.parquet, `frame` and `id` among them.
        robot: the columns wanted of robot.parquet, `frame` among them.

    Raises:
        BadInput: a file is missing or spoilt, of a version that had not all columns, or does not belong to
            the others.
    """
    files = RunFiles(
        truth=read_truth(folder / "truth" / "gt.txt"),
        tracks=read_tracks(folder / "tracks.txt"),
        people=_read_table(folder / "truth.parquet", TRUTH, people),
        beliefs=_read_table(folder / "tracks.parquet", TRACKS, TRACKS.names),
        robot=_read_table(folder / "robot.parquet", ROBOT, robot),
    )
    if files.robot["frame"].to_pylist() != list(range(1, frames + 1)):
        raise BadInput(
            f"{folder / 'robot.parquet'}: must have a row for each of the {frames} frames, "
            f"got {files.robot.num_rows}; {_AGAIN}"
        )
    for name in set(pc.unique(files.beliefs["status"]).to_pylist()) - set(Status):
        raise BadInput(f"{folder / 'tracks.parquet'}: unknown status {name!r}; {_AGAIN}")
    _check_inside(files.truth, folder / "truth" / "gt.txt", files.people, frames)
    _check_inside(files.tracks, folder / "tracks.txt", files.beliefs, frames)
    return files


def _read_table(path: Path, schema: pa.Schema, columns: Collection[str]) -> pa.Table:
    try:
        found = pq.read_schema(path)
        for name in columns:
            if name not in found.names:
                raise BadInput(f"{path}: has no column {name!r}; {_AGAIN}")
            was, must = found.field(name).type, schema.field(name).type
            if was != must:
                raise BadInput(f"{path}: column {name!r} must be {must}, got {was}; {_AGAIN}")
        table = pq.read_table(path, columns=list(columns))
    except (OSError, pa.ArrowException) as error:
        raise BadInput(f"{path}: cannot be read as a table of a run; {_AGAIN}") from error
    for name in columns:
        if table[name].null_count and name not in MAY_BE_EMPTY:
            raise BadInput(f"{path}: column {name!r} has rows without a value; {_AGAIN}")
    return table


def _check_inside(rows: Rows, path: Path, table: pa.Table, frames: int) -> None:
    """Refuse a text file with boxes beyond the run's end, or of somebody whom the table does not have."""
    check_end(rows, path, frames)
    known = set(zip(table["frame"].to_pylist(), table["id"].to_pylist(), strict=True))
    for frame, number in zip(rows.frame.tolist(), rows.id.tolist(), strict=True):
        if (frame, number) not in known:
            raise BadInput(f"{path}: frame {frame}: id {number} is not in the run's tables; {_AGAIN}")
