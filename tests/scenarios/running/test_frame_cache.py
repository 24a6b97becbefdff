from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.recorded_drives import read_drive, write_drive
from peopleboy.scenarios.running.frame_cache import Film, film, film_key, frames_of, open_film
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from tests.helpers.calls.refused import refused

SCENARIO = load_scenario("fast_turn").lasting(2.6)


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Film:
    return film(SCENARIO, 3, tmp_path_factory.mktemp("films"))


def played() -> Iterator[Frame]:
    before = None
    with SimulatedWorld(SCENARIO.world(3)) as world:
        calibrations = calibrations_of(world.cameras)
        for k in range(39):
            seen = world.observe()
            yield Frame.from_observation(seen, before, calibrations)
            before = seen.odometry
            # The script turns the robot from second 2 on; nothing is in its way.
            world.step(0.0, np.radians(90.0) if 30 <= k < 37.5 else 0.0)


def test_frames_from_disk_equal_those_of_the_run_to_the_byte(shot: Film) -> None:
    kept = list(frames_of(shot))
    assert len(kept) == shot.frames == 39
    for one, other in zip(kept, played(), strict=True):
        assert np.array_equal(one.grey(THERMAL), other.grey(THERMAL))
        assert np.array_equal(one.rgb(COLOUR), other.rgb(COLOUR))
        assert (one.time_s, one.odometry) == (other.time_s, other.odometry)
        points = np.array([[4.0, 0.3, 0.0], [7.0, -1.0, 1.7]])
        for camera in (THERMAL, COLOUR):
            pixels = [frame.calibrations[camera].project(points) for frame in (one, other)]
            assert np.array_equal(*pixels)


def test_truth_lies_beside_the_frames(shot: Film) -> None:
    assert shot.truth().last_frame == 39
    assert shot.people().num_rows == 39
    torso, whole = (shot.truth(kind) for kind in BoxKind)
    assert np.array_equal(torso.frame, whole.frame)
    assert (whole.box[:, 2] > torso.box[:, 2]).mean() > 0.9
    assert np.array_equal(whole.box[:, 0], shot.people()["whole_left_px"].to_numpy()[whole.frame - 1])


def test_a_film_is_made_once(shot: Film, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("peopleboy.sim.world.SimulatedWorld", None)
    assert film(SCENARIO, 3, shot.folder.parent) == shot


def test_a_film_that_was_cut_off_is_made_anew(tmp_path: Path) -> None:
    def stop(done: int, _all: int) -> None:
        if done == 5:
            raise KeyboardInterrupt

    short = SCENARIO.lasting(1.0)
    with pytest.raises(KeyboardInterrupt):
        film(short, 0, tmp_path, stop)
    assert list(tmp_path.iterdir()) == []
    assert film(short, 0, tmp_path).frames == 15


def test_another_seed_length_or_drive_gives_another_key() -> None:
    drive = [Command(linear_m_s=0.1, angular_rad_s=0.0)]
    keys = {film_key(SCENARIO, 3), film_key(SCENARIO, 4), film_key(SCENARIO.lasting(2.0), 3)}
    assert len(keys | {film_key(SCENARIO.driven(drive), 3)}) == 4
    assert film_key(load_scenario("fast_turn").lasting(2.6), 3) in keys


def test_a_further_camera_makes_another_film_of_the_same_frames(tmp_path: Path) -> None:
    films = []
    for cameras in ("{}", "{rear: {kind: thermal, yaw_deg: 180}}"):
        path = tmp_path / "seen.yaml"
        told = f"like: crossing_2\nname: seen\nduration_s: 0.2\nrobot: {{at_m: [1, 0], cameras: {cameras}}}\n"
        path.write_text(told, encoding="utf-8")
        films.append(film(load_scenario(path), 3, tmp_path).folder)
    assert films[0] != films[1]
    assert len({(folder / "frames.parquet").read_bytes() for folder in films}) == 1


def test_a_robot_that_follows_what_a_tracker_sees_is_refused_until_its_drive_is_recorded(
    tmp_path: Path,
) -> None:
    following = load_scenario("single_follow").lasting(0.2)
    with refused("single_follow: "):
        film(following, 0, tmp_path)
    assert film(following.driven([]), 0, tmp_path).frames == 3


def test_no_film_is_said_so(tmp_path: Path) -> None:
    with refused(tmp_path):
        open_film(tmp_path)


def test_a_drive_is_read_as_it_was_written(tmp_path: Path) -> None:
    drive = (Command(linear_m_s=0.1, angular_rad_s=1.0 / 3.0), Command(linear_m_s=0.0, angular_rad_s=-0.2))
    write_drive(tmp_path / "drive.parquet", drive)
    assert read_drive(tmp_path / "drive.parquet") == drive
    (tmp_path / "drive.parquet").write_text("no")
    with refused(tmp_path / "drive.parquet"):
        read_drive(tmp_path / "drive.parquet")
