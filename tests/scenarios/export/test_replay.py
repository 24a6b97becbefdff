from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.run_folder.run_tables import TRACKS, robot_row, track_rows, truth_rows
from peopleboy.sim.cameras.thermal import encode_16bit
from tests.helpers.calls.refused import refused


def images(run: Path, tick: Tick) -> list[np.ndarray]:
    name = f"{tick.frame:06d}.png"
    stored = [cv2.imread(str(run / kind / name), cv2.IMREAD_UNCHANGED) for kind in ("thermal", "thermal16")]
    return [*stored, cv2.imread(str(run / "colour" / name))[..., ::-1]]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["crossing", "following"])
def test_a_run_comes_out_again_to_the_bit(name: str, request: pytest.FixtureRequest) -> None:
    folder = request.getfixturevalue(name)
    run = open_run(folder)
    ticks = []
    for tick in replay(run):
        now = tick.observation.images
        again = (now["thermal"], encode_16bit(now["thermal_c"]), now["colour"])
        assert all(map(np.array_equal, again, images(folder, tick)))
        ticks.append(tick)
    assert len(ticks) == run.frames
    people = [row for tick in ticks for row in truth_rows(tick)]
    assert pa.Table.from_pylist(people, schema=pq.read_schema(folder / "truth.parquet")) == pq.read_table(
        folder / "truth.parquet"
    )
    assert [robot_row(tick) for tick in ticks] == pq.read_table(folder / "robot.parquet").to_pylist()
    tracks = [row for tick in ticks for row in track_rows(tick)]
    assert pa.Table.from_pylist(tracks, schema=TRACKS) == pq.read_table(folder / "tracks.parquet")


def test_the_robot_that_follows_was_stopped_in_an_emergency(following: Path) -> None:
    assert any(pq.read_table(following / "robot.parquet")["command_is_emergency"].to_pylist())


def changed(run: Path, to: Path, column: str, by: float) -> Path:
    shutil.copytree(run, to)
    table = pq.read_table(run / "truth.parquet")
    moved = pa.array([value + by for value in table[column].to_pylist()])
    pq.write_table(table.set_column(table.column_names.index(column), column, moved), to / "truth.parquet")
    return to


def test_a_run_that_comes_out_otherwise_is_refused_and_says_what_has_changed(
    crossing: Path, tmp_path: Path
) -> None:
    run = changed(crossing, tmp_path / "run", "left_px", 0.02)
    about = json.loads((run / "run.json").read_text())
    about["versions"]["numpy"] = "1.0"
    (run / "run.json").write_text(json.dumps(about))
    with refused(run, "frame 1", "numpy 1.0"):
        next(replay(open_run(run)))


def test_a_hundredth_of_a_pixel_is_let_pass(crossing: Path, tmp_path: Path) -> None:
    run = changed(crossing, tmp_path / "run", "left_px", 0.009)
    assert next(replay(open_run(run))).frame == 1


def test_a_run_of_an_older_version_without_a_column_is_refused(crossing: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    shutil.copytree(crossing, run)
    table = pq.read_table(run / "robot.parquet").drop_columns(["command_is_emergency"])
    pq.write_table(table, run / "robot.parquet")
    with refused(run / "robot.parquet", "'command_is_emergency'"):
        next(replay(open_run(run)))
