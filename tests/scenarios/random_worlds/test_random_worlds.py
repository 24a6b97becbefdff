"""Worlds drawn at random: all of them can be played, and are what the distribution says."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.export.make_dataset import of_worlds
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES, Distribution
from peopleboy.scenarios.random_worlds.drawn_values import drawn_values, histograms
from peopleboy.scenarios.random_worlds.random_world import random_scenario, random_world
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.some_of import some_of

QUICK = 40
ROUNDING = 0.011
BESIDE = {
    "age",
    "gait",
    "equipment",
    "thing",
    "sex",
    "top",
    "bottom",
    "hair",
    "posture",
    "carried",
    "coat",
    "headgear",
    "hands",
    "arms",
    "door",
    "place",
    "robot",
    "gain",
    "houses",
}


@pytest.fixture(scope="module")
def worlds() -> list[dict]:
    return [random_scenario(seed).resolved(seed) for seed in range(QUICK)]


def build(seed: int) -> None:
    config = random_scenario(seed).world(seed)
    assert config.detail == "full"


@pytest.mark.heavy
def test_a_thousand_worlds_are_built_without_one_failure() -> None:
    for seed in range(1000):
        build(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seeds", some_of([range(8), range(8, QUICK)], 2), ids=str)
def test_everything_drawn_lies_in_its_range(seeds: range) -> None:
    for seed in seeds:
        world = random_scenario(seed).resolved(seed)
        for name, values in drawn_values(world).items():
            if name in RANGES:
                inside = [RANGES[name].low - ROUNDING <= v <= RANGES[name].high + ROUNDING for v in values]
                assert all(inside), (world["name"], name, values)
            else:
                assert name in BESIDE
                assert set(values) <= set(SHARES.get(name, values))


@pytest.mark.thorough
def test_worlds_are_of_all_kinds(worlds: list[dict]) -> None:
    drawn = [drawn_values(world) for world in worlds]
    assert {kind for one in drawn for kind in one["place"]} == set(SHARES["place"])
    assert {number for one in drawn for number in one["people"]} >= set(range(1, 8))
    assert len({kind for one in drawn for kind in one["thing"]}) >= 20
    assert np.ptp([one["air"][0] for one in drawn]) > 15.0
    assert np.ptp([one["vertical_fov"][0] for one in drawn]) > 30.0
    assert {one["robot"][0] for one in drawn} == {"stands", "drives"}


def test_shares_sum_to_one_and_ranges_are_none_that_are_empty() -> None:
    assert all(sum(shares.values()) == pytest.approx(1.0) for shares in SHARES.values())
    assert all(spread.low < spread.high for spread in RANGES.values())
    assert all(0.0 < share < 1.0 for share, _ in ODDS.values())


def test_a_world_is_a_file_that_gives_it_again(tmp_path: Path) -> None:
    (tmp_path / "world.yaml").write_text(yaml.safe_dump(random_world(11)))
    again = load_scenario(tmp_path / "world.yaml")
    assert again.resolved(11) == random_scenario(11).resolved(11)


@pytest.mark.thorough
def test_the_same_seed_gives_the_same_world_in_another_process() -> None:
    code = (
        "import json; from peopleboy.scenarios.random_worlds.random_world import random_world;"
        "print(json.dumps([random_world(seed) for seed in (0, 7)]))"
    )
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert json.loads(told) == [random_world(0), random_world(7)]
    assert random_world(0) != random_world(7)


def test_a_longer_world_is_asked_for_by_its_length() -> None:
    assert random_world(3, 2.0)["duration_s"] == 2.0


def test_histograms_count_every_value() -> None:
    drawn = [drawn_values(random_scenario(seed).resolved(seed)) for seed in range(3)]
    rows = {what: counts for what, _, counts in histograms(drawn, Distribution())}
    assert sum(map(int, rows[RANGES["air"].what].split(" · "))) == 3
    assert sum(map(int, rows[RANGES["people"].what].split(" · "))) == 3
    sexes = [person for one in drawn for person in one["sex"]]
    assert rows["sex"].count(" ") == 2 * len(set(sexes)) - 1


@pytest.mark.heavy
def test_a_set_of_random_worlds_says_what_was_drawn_and_is_the_same_in_another_process(
    tmp_path: Path,
) -> None:
    order = ["render", "--random-worlds", "--seeds", "1", "--first-seed", "12", "--workers", "1", "--out"]
    assert run_cli(*order, tmp_path / "here") == 0
    subprocess.run([sys.executable, "-m", "peopleboy", *order, str(tmp_path / "there")], check=True)
    files = [path for path in sorted((tmp_path / "here").rglob("*")) if path.is_file()]
    digests = [
        [hashlib.sha256((tmp_path / home / path.relative_to(tmp_path / "here")).read_bytes()).hexdigest()
         for path in files]
        for home in ("here", "there")
    ]  # fmt: skip
    assert digests[0] == digests[1]
    here = tmp_path / "here"
    played = yaml.safe_load((here / "world_12" / "scenario.yaml").read_text())
    assert json.loads((here / "drawn.json").read_text())["world_12"] == drawn_values(played)
    about, sheet = json.loads((here / "dataset.json").read_text()), (here / "README.md").read_text()
    assert (about["random_worlds"], about["seeds"], about["first_seed"]) == (True, 1, 12)
    assert "peopleboy render --random-worlds --seeds 1 --first-seed 12" in sheet
    assert all(spread.what in sheet for name, spread in RANGES.items() if name in drawn_values(played))
    assert "train and test are empty; give --seeds 3" in sheet
    assert (here / "splits" / "val.txt").read_text() == "world_12\n"


@pytest.mark.thorough
def test_seven_worlds_in_a_row_have_all_splits() -> None:
    assert of_worlds(range(3, 10)).lacking == ""


@pytest.mark.parametrize(
    "order",
    [
        ("render",),
        ("render", "crossing_2", "--random-worlds"),
        ("sweep",),
        ("sweep", "crossing_2", "--random-worlds"),
    ],
)
def test_random_worlds_and_scenarios_do_not_go_together(
    order: tuple[object, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert_names(refusal(capsys, *order), order[0], "--random-worlds")


@pytest.mark.slow
def test_an_environment_draws_a_new_world_at_every_reset() -> None:
    env = PeopleBoyEnv(None, observation="truth")
    env.reset(seed=4)
    first = env.unwrapped._scenario.resolved(4)
    env.reset(seed=5)
    assert env.unwrapped._scenario.resolved(4) != first
    env.reset(seed=4)
    assert env.unwrapped._scenario.resolved(4) == first
    env.step((0.1, 0.0))
    env.close()
