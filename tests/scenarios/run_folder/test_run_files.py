from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.commands.inspect_commands import evaluate, report
from peopleboy.scenarios.run_folder.finished_run import open_run, runs_in
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRACKS, TRUTH
from tests.helpers.runs.toy_runs import write_run

Damage = Callable[[Path], object]
TABLES = {"truth.parquet": TRUTH, "tracks.parquet": TRACKS, "robot.parquet": ROBOT}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_run(tmp_path_factory.mktemp("toy") / "toy-0")


def read(folder: Path) -> object:
    return open_run(folder).files()


def damaged(whole: Path, to: Path, file: str, damage: Damage) -> Path:
    run = to / "run"
    shutil.copytree(whole, run)
    damage(run / file)
    return run


def without(column: str) -> Damage:
    return lambda path: pq.write_table(pq.read_table(path).drop_columns([column]), path)


def with_column(column: str, value: Any, kind: pa.DataType) -> Damage:
    def change(path: Path) -> None:
        table = pq.read_table(path)
        filled = pa.array([value] * table.num_rows, kind)
        pq.write_table(table.set_column(table.column_names.index(column), column, filled), path)

    return change


def halved(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def shortened(path: Path) -> None:
    table = pq.read_table(path)
    pq.write_table(table.slice(0, table.num_rows // 2), path)


def saying(**values: Any) -> Damage:
    return lambda path: path.write_text(json.dumps(json.loads(path.read_text()) | values))


def ending_with(share: float, end: str) -> Damage:
    """Cut after the first such characters behind this share of the text."""

    def cut(path: Path) -> None:
        text = path.read_text()
        path.write_text(text[: text.index(end, int(len(text) * share)) + len(end)])

    return cut


def with_line(line: str) -> Damage:
    return lambda path: path.write_text(path.read_text() + line)


def test_a_whole_run_is_read(whole: Path) -> None:
    files = open_run(whole).files()
    assert len(files.truth)
    assert len(files.tracks)
    assert [table.column_names for table in (files.people, files.beliefs, files.robot)] == [
        schema.names for schema in (TRUTH, TRACKS, ROBOT)
    ]


@pytest.mark.parametrize(
    ("file", "column"), [(file, column) for file, schema in TABLES.items() for column in schema.names]
)
def test_a_table_of_a_version_that_lacked_a_column_is_refused_by_its_name(
    whole: Path, tmp_path: Path, file: str, column: str
) -> None:
    run = damaged(whole, tmp_path, file, without(column))
    with pytest.raises(BadInput, match=rf"{file}: has no column '{column}'; run the scenario again$"):
        read(run)


DAMAGES: list[tuple[str, Damage, str]] = [
    ("tracks.parquet", Path.unlink, "tracks.parquet: cannot be read as a table of a run; run the scenario"),
    ("truth.parquet", halved, "truth.parquet: cannot be read as a table of a run; run the scenario again"),
    ("robot.parquet", shortened, "robot.parquet: must have a row for each of the .* frames, got"),
    ("truth.parquet", shortened, "gt.txt: frame .* is not in the run's tables"),
    ("tracks.parquet", shortened, "tracks.txt: frame .* is not in the run's tables"),
    ("robot.parquet", with_column("x_m", "x", pa.string()), "column 'x_m' must be double, got string"),
    ("truth.parquet", with_column("name", None, pa.string()), "column 'name' has rows without a value"),
    ("tracks.parquet", with_column("status", "gone", pa.string()), "unknown status 'gone'; run the scenario"),
    ("truth/gt.txt", with_line("9999,1,1.0,1.0,5.0,9.0,1,1,1.0\n"), "must end with frame"),
    ("truth/gt.txt", with_line("3,77,1.0,1.0,5.0,9.0,1,1,1.0\n"), "frame 3: id 77 is not in the run's"),
    ("truth/gt.txt", halved, "must have 9 numbers"),
    (
        "truth/gt.txt",
        ending_with(0.5, "\n"),
        r"gt.txt: has 9\d of the 180 boxes .* missing is id . in frame 4\d",
    ),
    (
        "tracks.txt",
        ending_with(0.5, "\n"),
        r"tracks.txt: has 9\d of the 180 boxes .* missing is id . in frame",
    ),
    ("truth/gt.txt", ending_with(0.995, ",1,1."), "gt.txt: ends in the middle of a line"),
    ("tracks.txt", Path.unlink, "tracks.txt: cannot be read as MOTChallenge text"),
    ("run.json", saying(frames="many"), "frames: must be a whole number, got 'many'"),
    ("run.json", saying(frames=3), "robot.parquet: must have a row for each of the 3 frames"),
    ("run.json", saying(seed=None), "seed: must be a whole number, got None; run the scenario again"),
    ("run.json", saying(renderer="vulkan"), "renderer: unknown renderer 'vulkan'"),
    ("run.json", saying(versions=[1]), "versions: must be a mapping"),
    ("run.json", saying(footage="clip"), "is a run of footage; give a run of a scenario"),
    ("run.json", saying(rate_hz=0), "rate_hz: must be at least 1, got 0"),
]


@pytest.mark.parametrize(("file", "damage", "says"), DAMAGES, ids=[says for _, _, says in DAMAGES])
def test_damage_is_told_in_one_line(
    whole: Path, tmp_path: Path, file: str, damage: Damage, says: str
) -> None:
    run = damaged(whole, tmp_path, file, damage)
    with pytest.raises(BadInput, match=says) as refusal:
        read(run)
    assert "\n" not in str(refusal.value)
    page = CliRunner().invoke(report, [str(run), "--out", str(tmp_path / "page.html")])
    assert isinstance(page.exception, BadInput)
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("name", ["truth/gt.txt", "tracks.txt"])
def test_half_a_file_is_not_scored_unless_nothing_tells_how_long_it_was(
    whole: Path, tmp_path: Path, name: str
) -> None:
    run = damaged(whole, tmp_path, name, ending_with(0.5, "\n"))
    told = str(CliRunner().invoke(evaluate, [str(run)]).exception)
    assert f"{name}: has " in told
    assert "of the 180 boxes in the run's tables" in told
    for table in ("truth.parquet", "tracks.parquet"):
        (run / table).unlink()
    assert CliRunner().invoke(evaluate, [str(run)]).exit_code == 0


@pytest.mark.parametrize("name", ["truth/gt.txt", "tracks.txt"])
def test_scores_are_refused_for_boxes_after_the_run_s_end(whole: Path, tmp_path: Path, name: str) -> None:
    run = damaged(whole, tmp_path, "run.json", saying(frames=3))
    other = "tracks.txt" if name == "truth/gt.txt" else "truth/gt.txt"
    (run / other).write_text("")
    result = CliRunner().invoke(evaluate, [str(run)])
    assert f"{name}: must end with frame 3, the run's last, got" in str(result.exception)


def test_a_run_is_opened_by_its_run_json_alone_and_the_rest_is_missed_when_asked_for(
    whole: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    shutil.copy(whole / "run.json", folder)
    run = open_run(folder)
    assert (run.name, run.title, run.frames, run.time_s(16)) == ("run", "toy, seed 0", 90, 1.0)
    for ask, file in (
        (lambda: run.played, "scenario.yaml"),
        (lambda: run.scenario, "scenario.yaml"),
        (lambda: run.metrics, "metrics.json"),
        (lambda: run.events, "events.jsonl"),
        (run.files, "gt.txt"),
    ):
        with pytest.raises(BadInput, match=re.escape(file)):
            ask()


def test_only_the_columns_asked_for_are_read_and_none_is_kept(whole: Path) -> None:
    run = open_run(whole)
    files = run.files(("frame", "id", "left_px", "whole_px", "hidden_by"), ("frame", "mode"))
    assert (files.people.num_columns, files.robot.num_columns) == (5, 2)
    assert run.files() is not run.files()
    assert [len(rows) for rows in run.files().people_by_frame().values()] == [2] * 90
    assert [track.id for track in run.files().tracks_by_frame()[1]] == [1, 2]
    assert run.files().tracks_by_frame()[91] == []


def test_a_folder_stands_for_its_runs_or_for_itself(whole: Path, tmp_path: Path) -> None:
    assert runs_in(whole) == [whole]
    assert runs_in(whole.parent) == [whole]
    assert runs_in(tmp_path) == [tmp_path]
    with pytest.raises(BadInput, match="folder not found"):
        runs_in(tmp_path / "nothing")
