import json
from datetime import date
from pathlib import Path

import pytest
from click.testing import CliRunner

from benchmarks import results as command
from benchmarks.results import (
    PATH,
    ResultColumn,
    ResultRow,
    ResultTable,
    ResultTables,
    as_yaml,
    read_tables,
    take_in,
)
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

SCENE = """
name: tiny
description: Somebody stands before the robot.
duration_s: 2.0
place: {kind: corridor, length_m: 9.0, width_m: 3.0}
people: [{name: anna, path: [{at_m: [6.5, 0.3], face: robot}]}]
robot: {at_m: [1.5, 0.0], behaviour: follow_person}
"""


def one_row(row: ResultRow, *columns: ResultColumn) -> ResultTable:
    return ResultTable(
        command="make it", recorded="2020-01-01", seeds="seed 0", chosen_on="", columns=columns, rows=(row,)
    )


def test_the_file_is_written_as_it_is_read() -> None:
    assert as_yaml(read_tables()) == PATH.read_text(encoding="utf-8")


def test_figures_of_a_json_file_are_taken_in_and_gaps_stay(tmp_path: Path) -> None:
    path = tmp_path / "found.json"
    path.write_text(json.dumps({"anna": {"runs": [{}, {}], "mean": {"share": [0.25, 0.1]}}}))
    row = ResultRow(name="anna", measured=f"{path}#/anna", runs=2, figures=(99.0, None, 7.0))
    columns = (
        ResultColumn(name="share", key="/mean/share/0", factor=100.0),
        ResultColumn(name="none", key="/none"),
    )
    taken = take_in(one_row(row, *columns, ResultColumn(name="by hand")))
    assert taken.rows[0].figures == (25.0, None, 7.0)
    assert taken.recorded == date.today().isoformat()


@pytest.mark.thorough
def test_runs_are_scored_together_and_their_drives_averaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("tiny.yaml").write_text(SCENE, encoding="utf-8")
    scene, found, errors = load_scenario("tiny.yaml"), 0, []
    for name, seed in (("tiny-0", 0), ("tiny-1", 1), ("tiny-0-thesis", 0)):
        run(scene, RunOptions(seed=seed, out=Path(name), record=False), lambda *_: None)
    for name in ("tiny-0", "tiny-1"):
        metrics = json.loads(Path(name, "metrics.json").read_text(encoding="utf-8"))
        found += metrics["counts"]["matches"]
        errors.append(metrics["following"]["mean_distance_error_m"])
    row = ResultRow(name="tiny", measured="tiny-*", runs=2, figures=(0.0, 0.0, 0.0))
    keys = ("/scores/counts/matches", "/mean/mean_distance_error_m", "/worst/mean_distance_error_m")
    taken = take_in(one_row(row, *(ResultColumn(name=key, key=key) for key in keys)))
    assert taken.rows[0].figures == pytest.approx((found, sum(errors) / 2, max(errors)))


@pytest.mark.parametrize(
    ("row", "key", "complaint"),
    [
        ({"measured": "found.json", "runs": 3}, "/CP", "has 2 runs, expected 3; run the measurement first"),
        ({"measured": "found.json", "runs": 2}, "/CR", "found.json: x has no /CR"),
        ({"measured": "found.json", "runs": 2}, "/name", "/name must be a number, got 'x'"),
        ({"measured": "gone.json"}, "/CP", "gone.json: no results found; run the measurement first"),
        ({"measured": "gone-*"}, "/CP", "gone-*: no runs found; run the measurement first"),
        ({}, "/CP", "`make it` only prints its results"),
    ],
)
def test_what_was_not_measured_is_refused(
    row: dict[str, object], key: str, complaint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("found.json").write_text(json.dumps({"runs": 2, "CP": 99.0, "name": "x"}))
    table = one_row(ResultRow(name="x", figures=(1.0,), **row), ResultColumn(name="CP", key=key))
    with pytest.raises(BadInput) as refused:
        take_in(table)
    assert complaint in str(refused.value)


def test_a_row_without_a_figure_for_each_column_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "results.yaml"
    table = {"command": "a", "recorded": "b", "seeds": "c", "columns": [{"name": "CP"}], "rows": []}
    path.write_text(json.dumps({"tables": {"t": table | {"rows": [{"name": "x", "figures": [1, 2]}]}}}))
    with pytest.raises(BadInput, match="x: 2 values for 1 columns"):
        read_tables(path)


def test_the_command_writes_what_it_took_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("found.json").write_text(json.dumps({"CP": 98.0}))
    before = ResultTables(
        tables={
            "one": one_row(
                ResultRow(name="x", measured="found.json", figures=(1.0,)), ResultColumn(name="CP", key="/CP")
            )
        }
    )
    Path("results.yaml").write_text(as_yaml(before))
    monkeypatch.setattr(command, "PATH", Path("results.yaml"))
    monkeypatch.setattr(command, "read_tables", lambda: read_tables(Path("results.yaml")))
    assert "make it" in CliRunner().invoke(command.main, []).output
    assert CliRunner().invoke(command.main, ["one"]).exit_code == 0
    assert read_tables(Path("results.yaml")).tables["one"].rows[0].figures == (98.0,)
    assert isinstance(CliRunner().invoke(command.main, ["two"]).exception, BadInput)
