"""Episodes of environments in the layout of LeRobot; the library itself needs other versions of packages."""

import json
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.runs.episodes import ARRIVING, played


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Two episodes as they were played, and the folder to which they were exported."""
    folder = tmp_path_factory.mktemp("lerobot")
    size = {"observation": "pixels", "image_size": (160, 120)}
    one, two = played(folder / "one", 5, **size), played(folder / "two", 3, ARRIVING, task="go_to", **size)
    three = played(folder / "three", 4, **size)
    runs = (folder / "one", folder / "three")
    out = folder / "out"
    assert run_cli("export", *runs, "--format", "lerobot", "--camera", "thermal", "--out", out) == 0
    return {"episodes": (one, three), "other": two, "folder": folder, "out": out}


def test_the_steps_are_those_of_the_environment(found: dict[str, Any]) -> None:
    start = 0
    for number, episode in enumerate(found["episodes"]):
        table = pq.read_table(found["out"] / "data" / "chunk-000" / f"file-{number:03d}.parquet")
        count = len(episode["rewards"])
        seen = episode["observations"][:count]
        state = [np.concatenate([one["odometry"], one["sonar"]]) for one in seen]
        assert np.array_equal(table["observation.state"].to_pylist(), np.array(state))
        np.testing.assert_allclose(table["action"].to_pylist(), episode["actions"], atol=1e-6)
        np.testing.assert_allclose(table["next.reward"].to_pylist(), episode["rewards"], atol=1e-6)
        assert table["index"].to_pylist() == list(range(start, start + count))
        for image, one in zip(table["observation.images.thermal"].to_pylist(), seen, strict=True):
            picture = cv2.imdecode(np.frombuffer(image["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)
            assert np.array_equal(picture, np.repeat(one["thermal"], 3, axis=2))
        start += count


def test_features_episodes_and_tasks_are_described(found: dict[str, Any]) -> None:
    meta = found["out"] / "meta"
    about = json.loads((meta / "info.json").read_text())
    assert (about["codebase_version"], about["total_episodes"], about["total_frames"]) == ("v3.0", 2, 9)
    assert about["features"]["observation.images.thermal"]["shape"] == [120, 160, 3]
    assert len(about["features"]["observation.state"]["names"]) == 22
    episodes = pq.read_table(meta / "episodes" / "chunk-000" / "file-000.parquet").to_pylist()
    assert [(one["dataset_from_index"], one["dataset_to_index"]) for one in episodes] == [(0, 5), (5, 9)]
    tasks = pq.read_table(meta / "tasks.parquet")
    assert tasks.to_pylist() == [{"task_index": 0, "__index_level_0__": "Follow the person."}]
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["__index_level_0__"]


def test_the_statistics_are_those_of_all_steps(found: dict[str, Any]) -> None:
    stats = json.loads((found["out"] / "meta" / "stats.json").read_text())
    steps = [one for of in found["episodes"] for one in of["observations"][:-1]]
    sonar = np.array([one["sonar"] for one in steps], np.float64)
    for kind, value in (("mean", sonar.mean(axis=0)), ("q90", np.quantile(sonar, 0.9, axis=0))):
        assert stats["observation.state"][kind][6:] == pytest.approx(value.tolist())
    pixels = np.array([one["thermal"] for one in steps]) / 255.0
    thermal = stats["observation.images.thermal"]
    assert np.shape(thermal["mean"]) == (3, 1, 1)
    for kind, number in (("mean", pixels.mean()), ("std", pixels.std()), ("max", pixels.max())):
        assert np.ravel(thermal[kind]) == pytest.approx(number)
    for kind, share in (("q01", 0.01), ("q50", 0.5), ("q99", 0.99)):
        assert np.ravel(thermal[kind]) == pytest.approx(np.quantile(pixels, share), abs=1.0 / 255.0)


def test_the_library_reads_steps_and_sequences(found: dict[str, Any]) -> None:
    module = pytest.importorskip("lerobot.datasets.lerobot_dataset")
    dataset = module.LeRobotDataset(
        "peopleboy/episodes", root=found["out"], delta_timestamps={"action": [0.0, 1.0 / 15.0]}
    )
    assert dataset[0]["action"].shape == (2, 2)
    assert dataset[0]["task"] == "Follow the person."


def test_other_observations_are_refused(found: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    runs = (found["folder"] / "one", found["folder"] / "two")
    line = refusal(capsys, "export", *runs, "--format", "lerobot", "--out", found["folder"] / "mixed")
    assert "observations differ" in line
    assert not (found["folder"] / "mixed").exists()
