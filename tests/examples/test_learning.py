import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from examples.learning import evaluate, train, worlds
from examples.learning.evolution import evolve
from examples.learning.follower import SIZE, SPEED_SIGHTS, TURN_SIGHTS, LearnedFollower, load_weights
from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.behaviours.following.follow_person import FollowPerson
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD

TINY = """
name: tiny
description: Somebody walks away from the robot.
duration_s: 1.0
place: {kind: corridor, length_m: 12.0, width_m: 3.0}
people: [{name: anna, path: [{at_m: [5.0, 0.3]}, {at_m: [11.0, 0.3]}]}]
robot: {at_m: [1.5, 0.0], behaviour: follow_person}
"""


def percepts(mirror: int = 1) -> list[Percept]:
    """Somebody walks away to one side and is gone; 1 as it is, -1 as in a mirror."""
    seen = [(0.01 * n, 0.5 - 0.004 * n) for n in range(60)]
    ranges = np.linspace(1.0, 4.0, 16)
    return [
        Percept(
            time_s=n / 15.0,
            people=(
                SeenPerson(
                    id=1, x=mirror * seen[n][0], height=seen[n][1], top=0.2, bottom=0.2 + seen[n][1],
                    confidence=1.0, is_visible=True,
                ),
            ) if n < 60 else (),
            sonar_m=ranges if mirror == 1 else ranges[[7 - k if k < 8 else 23 - k for k in range(16)]],
            sonar_angle_rad=SONAR_ANGLE_RAD,
            linear_m_s=0.3,
            angular_rad_s=-0.2 * mirror,
        )
        for n in range(75)
    ]  # fmt: skip


def driven(behaviour: LearnedFollower | FollowPerson, mirror: int = 1) -> list[Command]:
    return [behaviour.command(percept) for percept in percepts(mirror)]


def test_with_weights_of_zero_it_is_the_written_follower() -> None:
    assert driven(LearnedFollower(np.zeros(SIZE))) == driven(FollowPerson())


def test_in_a_mirror_it_turns_the_other_way_and_drives_as_fast() -> None:
    rng = np.random.default_rng(0)
    weights = rng.normal(0.0, 0.5, SIZE)
    one, other = driven(LearnedFollower(weights)), driven(LearnedFollower(weights), mirror=-1)
    following = slice(1, 60)  # whoever is nowhere yet is looked for to the left
    for a, b in zip(one[following], other[following], strict=True):
        assert a.linear_m_s == pytest.approx(b.linear_m_s)
        assert a.angular_rad_s == pytest.approx(-b.angular_rad_s)


def test_each_weight_corrects_by_its_sight_and_never_beyond_the_limits() -> None:
    weights = np.zeros(SIZE)
    weights[SPEED_SIGHTS.index("follow")] = 0.5
    for corrected, written in zip(driven(LearnedFollower(weights)), driven(FollowPerson()), strict=True):
        assert corrected.angular_rad_s == written.angular_rad_s
        wanted = written.linear_m_s + 0.4 * math.tanh(0.5)
        assert corrected.linear_m_s in (pytest.approx(wanted), pytest.approx(0.8), written.linear_m_s)
    weights = np.full(SIZE, 9.0)
    assert all(-0.25 <= one.linear_m_s <= 0.8 for one in driven(LearnedFollower(weights)))
    assert all(abs(one.angular_rad_s) <= 1.2 for one in driven(LearnedFollower(weights)))


def test_senseless_input_stops_it_whatever_it_learned() -> None:
    follower = LearnedFollower(np.ones(SIZE))
    follower.command(percepts()[0])
    command = follower.command(replace(percepts()[1], linear_m_s=math.nan))
    assert (follower.mode, command.linear_m_s, command.angular_rad_s) == ("blind", 0.0, 0.0)


def test_what_ships_is_small_loads_without_pickles_and_goes_where_behaviours_go() -> None:
    assert LearnedFollower.file.stat().st_size < 10_000
    assert np.any(load_weights(LearnedFollower.file))
    assert make_behaviour("examples.learning.follower:LearnedFollower").mode == "search"


def test_weights_that_do_not_fit_are_refused_in_one_line(tmp_path: Path) -> None:
    np.save(tmp_path / "bare.npy", np.zeros(SIZE))
    for name in ("nowhere.npz", "bare.npy"):
        with pytest.raises(BadInput, match=r"examples\.learning\.train"):
            load_weights(tmp_path / name)
    np.savez(tmp_path / "short.npz", weights=np.zeros(3))
    with pytest.raises(BadInput, match=rf"\({SIZE},\)"):
        load_weights(tmp_path / "short.npz")
    assert len(SPEED_SIGHTS) + len(TURN_SIGHTS) == SIZE


def test_evolution_finds_the_top_of_a_hill_and_shrinks_its_steps_there() -> None:
    top = np.array([1.0, -2.0, 0.5, 3.0])
    *_, last = evolve(
        np.zeros(4), 0.5, lambda _, members: [-float(((w - top) ** 2).sum()) for w in members],
        np.random.default_rng(1), members=10, generations=80,
    )  # fmt: skip
    assert last.mean == pytest.approx(top, abs=0.02)
    assert last.spread < 0.05


@pytest.mark.slow
def test_training_repeats_whoever_does_it_and_its_weights_are_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = tmp_path / "tiny.yaml"
    scene.write_text(TINY, encoding="utf-8")
    kept = [tmp_path / "a.npz", tmp_path / "b.npz"]
    for file in kept:
        options = ["--generations", "1", "--members", "4", str(scene), "--out", str(file)]
        done = CliRunner().invoke(train.main, options)
        assert done.exit_code == 0, done.output
    assert np.array_equal(*(load_weights(file) for file in kept))
    monkeypatch.setattr(evaluate, "NEVER_SEEN", (str(scene),))
    told = tmp_path / "figures.json"
    options = ["--policy", str(kept[0]), "--seeds", "2", "--eyes", "truth", "--out", str(told)]
    done = CliRunner().invoke(evaluate.main, options)
    assert done.exit_code == 0, done.output
    figures = json.loads(told.read_text(encoding="utf-8"))
    assert figures["runs"] == 2
    gain = figures["learned"]["reward"]["mean"] - figures["written"]["reward"]["mean"]
    assert figures["difference"]["reward"]["mean"] == pytest.approx(gain)


def test_unsure_eyes_are_off_by_as_much_as_a_tracker_and_never_about_who() -> None:
    eyes = worlds.Unsure(0)
    row = (4.0, 0.0, 0.5, 0.2, 0.7, 1.0, 1.0)
    told = {"tracks": np.array([row, *[(0.0,) * 7] * 4], np.float32).reshape(-1)}
    seen = np.array([eyes(told)["tracks"].reshape(5, 7) for _ in range(2000)])
    assert np.all(seen[:, 0, 0] == 4.0)
    assert not seen[:, 1:].any()
    assert seen[:, 0, 1].std() == pytest.approx(0.02, rel=0.3)
    assert np.log(seen[:, 0, 2] / 0.5).std() == pytest.approx(0.04, rel=0.3)
    assert np.mean(seen[:, 0, 6]) == pytest.approx(0.98, abs=0.01)
