from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from rerun.chunk import RrdReader

from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.loop.run_events import describe
from peopleboy.scenarios.report.columns import read_columns
from peopleboy.scenarios.report.page_tables import moves
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.run_folder.folder import things_camera
from peopleboy.scenarios.run_folder.run_tables import THINGS
from peopleboy.scenarios.running.run import run as play
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.cameras.camera_config import ThermalConfig
from tests.helpers.calls.refused import refused

SCENE = {
    "name": "moved",
    "description": "A woman moves a box, which vanishes.",
    "duration_s": 3.4,
    "place": {"kind": "room", "length_m": 6.0, "width_m": 5.0},
    "things": [
        {
            "kind": "block",
            "name": "box",
            "at_m": [3.6, 0.0],
            "size_m": [0.4, 0.4, 0.6],
            "actions": [
                {"at_s": 1.0, "kind": "glide", "to_m": [3.6, 0.5], "takes_s": 1.0, "by": "anna"},
                {"at_s": 3.0, "kind": "vanish"},
            ],
        }
    ],
    "people": [{"name": "anna", "path": [{"at_m": [4.2, 0.2], "face": [3.6, 0.2]}]}],
    "robot": {"at_m": [1.0, 0.0], "cameras": {"depth": {"kind": "depth", "preset": "kinect"}}},
}


def _silently(*_: object) -> None:
    """Report nothing."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("runs") / "moved"
    scenario = parse_scenario(SCENE, source="moved.yaml", folder=out)
    play(scenario, RunOptions(seed=0, out=out, frames=True), _silently)
    return out


@pytest.mark.slow
def test_the_table_says_of_every_frame_where_the_thing_is_and_who_moves_it(run: Path) -> None:
    table = pq.read_table(run / "truth/things.parquet")
    assert table.schema == THINGS
    rows = table.to_pylist()
    assert [row["frame"] for row in rows] == list(range(1, 52))
    assert (rows[0]["y_m"], rows[0]["moved_by"], rows[0]["is_moving"]) == (0.0, None, False)
    assert (rows[22]["moved_by"], rows[22]["is_moving"]) == ("anna", True)
    assert rows[22]["y_m"] == pytest.approx(0.5 * (0.4667**2) * (3 - 2 * 0.4667), abs=0.001)
    assert (rows[40]["y_m"], rows[40]["is_there"]) == (0.5, True)
    assert rows[40]["visible_px"] > 1000 > rows[50]["visible_px"] == 0
    assert (rows[50]["is_there"], rows[50]["left_px"]) == (False, None)
    assert 0 < rows[0]["left_px"] < rows[0]["left_px"] + rows[0]["width_px"] < 320  # in the depth image


def test_the_log_says_who_moved_it_how_far_and_reads_back(run: Path) -> None:
    lines = [json.loads(line) for line in (run / "events.jsonl").read_text().splitlines()]
    moved, gone = (line for line in lines if line["kind"].startswith("thing"))
    assert (moved["kind"], moved["who"], moved["other"]) == ("thing moved", "box", "anna")
    assert moved["move"] == {
        "from_s": 1.0, "to_s": 2.0, "from_m": [3.6, 0.0, 0.0], "to_m": [3.6, 0.5, 0.0],
        "distance_m": 0.5, "turned_deg": 0.0,
    }  # fmt: skip
    assert "move" not in gone
    events = [line for line in open_run(run).events if line.kind.startswith("thing")]
    assert [describe(line) for line in events] == ["box: moved 0.50 m by anna", "box: vanished"]
    (column,) = read_columns([run])
    assert [row[2] for row in moves(column.found).rows] == ["moved 0.50 m", "vanished"]


def test_backgrounds_lie_beside_the_truth(run: Path) -> None:
    clean, ever = (cv2.imread(str(run / f"truth/depth_{kind}.png"), -1) for kind in ("clean", "ever"))
    assert clean.dtype == ever.dtype == np.uint16
    assert clean.shape == ever.shape == (240, 320)
    assert clean.min() > 2000
    assert (ever <= clean + 5).mean() > 0.999
    seen = cv2.imread(str(run / "depth/000001.png"), -1)
    assert 0.02 < np.mean((seen > 0) & (seen < clean - 300.0)) < 0.3


def test_the_recording_has_the_thing_in_a_frame_of_its_own_that_moves_and_shrinks_to_nothing(
    run: Path,
) -> None:
    found: dict[str, list[object]] = {}
    for chunk in RrdReader(run / "recording.rrd").stream():
        if str(chunk.entity_path).removeprefix("/") == "world/place/moved/box":
            batch = chunk.to_record_batch()
            for name in batch.schema.names:
                if name.startswith("Transform3D:"):
                    found.setdefault(name, []).extend(batch.column(name).to_pylist())
    assert found["Transform3D:translation"][-1] == [pytest.approx([3.6, 0.5, 0.0])]
    scales = [row[0][0] for row in found["Transform3D:scale"] if row]  # type: ignore[index]
    assert scales[0] == 1.0 > scales[-1] > 0.0


def test_the_plan_shows_where_things_are_moved_to(run: Path, tmp_path: Path) -> None:
    draw_plan(open_run(run).scenario, 0, tmp_path / "moved.png")
    still = {**SCENE, "things": [{**SCENE["things"][0], "actions": []}]}  # type: ignore[index]
    draw_plan(parse_scenario(still, source="still.yaml", folder=tmp_path), 0, tmp_path / "still.png")
    with_moves, without = (cv2.imread(str(tmp_path / f"{name}.png")) for name in ("moved", "still"))
    assert (with_moves != without).any()


def test_without_movable_things_there_is_no_table_and_thermal_stands_in_for_depth(tmp_path: Path) -> None:
    still = {**SCENE, "duration_s": 0.2, "things": [], "robot": {"at_m": [1.0, 0.0]}}
    scenario = parse_scenario(still, source="still.yaml", folder=tmp_path)
    play(
        scenario,
        RunOptions(seed=0, out=tmp_path / "run", frames=True, record=False),
        _silently,
    )
    files = (path for path in (tmp_path / "run/truth").iterdir() if path.is_file())
    assert sorted(path.name for path in files) == [
        "colour.gt.txt",
        "colour.parquet",
        "gt.txt",
    ]
    assert things_camera({"thermal": ThermalConfig()}) == "thermal"


def test_an_event_that_is_no_line_of_a_log_is_refused(run: Path, tmp_path: Path) -> None:
    for name in ("run.json", "scenario.yaml"):
        (tmp_path / name).write_text((run / name).read_text())
    (tmp_path / "events.jsonl").write_text('{"frame": 1, "move": {"way": 2}}\n')
    with refused("events.jsonl", "event log"):
        _ = open_run(tmp_path).events
