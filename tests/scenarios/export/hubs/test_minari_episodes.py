"""Episodes of environments are read by Minari as they were played."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.helpers.calls.command_line import run_cli
from tests.helpers.runs.episodes import ARRIVING, SHORT, played
from tests.helpers.runs.exported import make_run

minari = pytest.importorskip("minari")

STEPS = 12


def exported(out: Path, *runs: Path, options: tuple[str, ...] = ()) -> Any:
    assert run_cli("export", *runs, "--format", "minari", "--out", out, *options) == 0
    return minari.MinariDataset(out / "peopleboy" / "episodes-v0" / "data")


@pytest.mark.parametrize("tracker", ["truth", "contour"])
def test_an_episode_has_the_observations_actions_and_rewards_of_its_environment(
    tracker: str, tmp_path: Path
) -> None:
    found = played(tmp_path / "run", STEPS, observation="tracks", tracker=tracker)
    (episode,) = exported(tmp_path / "out", tmp_path / "run").iterate_episodes()
    for name in ("sonar", "odometry", "tracks"):
        assert np.array_equal(episode.observations[name], [one[name] for one in found["observations"]]), name
    np.testing.assert_allclose(episode.actions, found["actions"], atol=1e-6)
    np.testing.assert_allclose(episode.rewards, found["rewards"], atol=1e-12)
    assert not episode.terminations.any()
    assert episode.truncations.tolist() == [False] * (STEPS - 1) + [True]


def test_an_image_is_that_of_the_camera(tmp_path: Path) -> None:
    size = (160, 120)
    found = played(tmp_path / "run", 3, observation="pixels", image_size=size)
    dataset = exported(tmp_path / "out", tmp_path / "run", options=("--camera", "thermal"))
    images = dataset[0].observations["thermal"]
    assert np.array_equal(images, [one["thermal"] for one in found["observations"]])


def test_several_episodes_say_how_they_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    arrived = played(tmp_path / "arrived", 99, ARRIVING, task="go_to", observation="truth")
    cut = played(tmp_path / "cut", 5, ARRIVING, task="go_to", observation="truth")
    assert arrived["ends"]
    exported(tmp_path / "out", tmp_path / "arrived", tmp_path / "cut")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "out"))
    dataset = minari.load_dataset("peopleboy/episodes-v0")
    one, other = dataset.iterate_episodes()
    assert (one.terminations[-1], one.truncations[-1]) == (True, False)
    assert (other.terminations[-1], other.truncations[-1]) == (False, True)
    assert np.array_equal(one.observations["goal"], [seen["goal"] for seen in arrived["observations"]])
    assert dataset.total_steps == len(arrived["rewards"]) + len(cut["rewards"])
    about = next(iter(dataset.storage.get_episode_metadata([0])))
    assert (about["run"], about["seed"], about["ended"]) == ("arrived", 3, "arrival")


def test_the_step_at_which_time_is_over_is_left_out(tmp_path: Path) -> None:
    found = played(tmp_path / "run", 99, SHORT, observation="truth")
    assert found["is_cut"]
    dataset = exported(tmp_path / "out", tmp_path / "run")
    assert len(dataset[0].rewards) == len(found["rewards"]) - 1
    assert dataset[0].truncations[-1]


def test_other_runs_and_other_observations_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = make_run(SHORT, tmp_path / "run")
    assert run_cli("export", run, "--format", "minari", "--out", tmp_path / "out") == 2
    assert "env.save()" in capsys.readouterr().err
    played(tmp_path / "a", 2, observation="truth")
    played(tmp_path / "b", 2, ARRIVING, task="go_to", observation="truth")
    folders = (tmp_path / "a", tmp_path / "b")
    assert run_cli("export", *folders, "--format", "minari", "--out", tmp_path / "out") == 2
    assert "observations differ" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
