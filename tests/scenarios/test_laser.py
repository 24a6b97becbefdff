"""A laser range finder in a scenario: in the run folder, the recording, the ROS bag and environments."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rerun.chunk import RrdReader

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.load import load_scenario
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.runs.exported import SCENE, export


def scene(**laser: object) -> dict[str, object]:
    return SCENE | {
        "name": "scanned",
        "duration_s": 0.6,
        "place": {"kind": "room", "length_m": 9.0, "width_m": 6.0},
        "things": [{"kind": "table", "at_m": [5.0, 1.5]}],
        "people": [{"name": "carl", "path": [{"at_m": [4.0, 0.1]}]}],
        "robot": {"at_m": [1.0, 0.0], "cameras": {"laser": {"kind": "laser", **laser}}},
    }


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("laser")
    (folder / "scene.yaml").write_text(yaml.safe_dump(scene(rate_hz=5)), encoding="utf-8")
    assert run_cli("run", folder / "scene.yaml", "--out", folder / "run") == 0
    return folder / "run"


def rows_of(run: Path) -> list[dict[str, list[float]]]:
    rows: list[dict[str, list[float]]] = pq.read_table(run / "scans" / "laser.parquet").to_pylist()
    return rows


def test_a_run_keeps_ranges_and_the_person_at_each_beam(run: Path) -> None:
    rows = rows_of(run)
    assert [row["frame"] for row in rows] == [1, 4, 7]
    for row in rows:
        assert len(row["range_m"]) == len(row["true_range_m"]) == len(row["person"]) == 360
        hits = [near for near, person in zip(row["range_m"], row["person"], strict=True) if person == 1]
        assert 4 < len(hits) < 40
        assert all(2.3 < near < 3.1 for near in hits)
    assert not (run / "truth" / "laser.parquet").exists()


def test_the_recording_shows_the_points_of_each_scan_in_the_world(run: Path) -> None:
    found = [
        np.concatenate(chunk.to_record_batch().column("Points3D:positions").to_pylist()[0])
        for chunk in RrdReader(run / "recording.rrd").stream()
        if chunk.entity_path == "/world/points/laser"
        and "Points3D:positions" in chunk.to_record_batch().schema.names
    ]
    points = np.concatenate(found).reshape(-1, 3)
    assert points[:, 2].min() > 0.28
    assert points[:, 0].max() < 9.1


def test_a_ros_bag_has_scans_whose_beams_turn_to_the_left(run: Path, tmp_path: Path) -> None:
    (bag,) = export(run, "mcap", tmp_path / "bag").glob("**/*.mcap")
    with bag.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [one.decoded_message for one in _decoded(reader, "/laser/scan")]
        frames = [one.decoded_message for one in _decoded(reader, "/tf_static")]
    assert len(found) == 3
    scan, row = found[0], rows_of(run)[0]
    assert scan.angle_min == pytest.approx(-math.radians(89.75))
    assert scan.angle_min + (len(scan.ranges) - 1) * scan.angle_increment == pytest.approx(scan.angle_max)
    given = [math.inf if one is None else one for one in reversed(row["range_m"])]
    assert np.allclose(scan.ranges, given)
    assert scan.header.frame_id in {one.child_frame_id for all_ in frames for one in all_.transforms}


def _decoded(reader: object, topic: str) -> list[object]:
    return list(reader.iter_decoded_messages(topics=[topic]))  # type: ignore[attr-defined]


def test_an_environment_gives_scans_under_the_name_of_the_range_finder(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(scene()), encoding="utf-8")
    env = PeopleBoyEnv(str(path), observation="pixels", cameras=["laser"])
    observation, _ = env.reset(seed=0)
    assert observation["laser"].shape == (1, 360, 1)
    assert env.observation_space.contains(observation)
    env.close()


def test_a_step_that_does_not_fit_is_refused_with_its_key(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(scene(step_deg=0.7)), encoding="utf-8")
    assert "robot.cameras.laser.step_deg" in refusal(capsys, "run", path, "--out", tmp_path / "run")


def test_a_scenario_without_a_range_finder_has_no_table_of_scans() -> None:
    assert "laser" not in load_scenario("crossing_2").robot.config().cameras
