import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.studies.training.detector.worlds import (
    KINDS,
    crowded_world,
    ordinary_world,
    with_library_span,
    with_warm_air,
    world_of,
)
from peopleboy.tracker.frame import THERMAL


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 9])
def test_a_world_with_library_span_is_seen_plainly_from_24_to_36_degrees(seed: int) -> None:
    before = random_world(seed)
    world = parse_scenario(with_library_span(before), source="world", folder=Path()).world(seed)
    thermal = world.robot.cameras[THERMAL]
    assert (thermal.gain, thermal.lowest_c, thermal.highest_c) == ("fixed", 24.0, 36.0)
    assert before == random_world(seed)  # left alone


@pytest.mark.parametrize(("seed", "is_warm"), [(1, True), (3, False), (4, True), (6, False)])
def test_a_world_with_library_span_is_cold_without_sun_and_details(seed: int, is_warm: bool) -> None:
    before = random_world(seed)
    world = with_library_span(before)
    assert "sun" not in world["place"]
    assert world["detail"] == "plain"
    assert world["place"].get("temperatures") == (None if is_warm else before["place"]["temperatures"])


@pytest.mark.parametrize("seed", [1, 3])
def test_a_world_with_warm_air_is_warmer_by_the_same_all_over(seed: int) -> None:
    before = random_world(seed)
    world = with_warm_air(before, 30.0)
    was, warm = (one["place"]["temperatures"] for one in (before, world))
    assert warm["air_c"] == 30.0
    for key in ("walls_c", "floor_c", "ceiling_c", "surroundings_c"):
        assert warm[key] - was[key] == pytest.approx(30.0 - was["air_c"], abs=0.02)
    thermal = parse_scenario(world, source="world", folder=Path()).world(seed).robot.cameras[THERMAL]
    assert (thermal.gain, thermal.lowest_c, thermal.highest_c) == ("fixed", 24.0, 36.0)
    assert "sun" not in world["place"]
    assert before == random_world(seed)  # left alone


@pytest.mark.parametrize("seed", range(3))
def test_a_crowded_world_can_be_played_and_some_walk_side_by_side(seed: int) -> None:
    world = crowded_world(seed)
    assert world == crowded_world(seed)
    parse_scenario(world, source="world", folder=Path())
    people = {person["name"]: person for person in world["people"]}
    beside = [name for name in people if name.endswith("_beside")]
    for name in beside:
        paths = [
            np.array([point["at_m"] for point in one["path"]])
            for one in (people[name], people[name.removesuffix("_beside")])
        ]
        aside = paths[0] - paths[1]
        np.testing.assert_allclose(aside, aside[:1].repeat(len(aside), 0), atol=0.011)
        assert 0.43 < math.hypot(*aside[0]) < 0.92


@pytest.mark.thorough
def test_crowds_are_larger_than_worlds_as_drawn() -> None:
    drawn, crowded = (
        np.mean([len(draw(seed).get("people", ())) for seed in range(5)])
        for draw in (random_world, crowded_world)
    )
    assert crowded > 1.3 * drawn


@pytest.mark.slow
def test_worlds_of_each_kind_have_seeds_of_their_own() -> None:
    assert sum(kind.share for kind in KINDS) == pytest.approx(1.0)
    seeds = [seed for kind in KINDS for seed in kind.seeds(2000)]
    assert len(set(seeds)) == len(seeds) == 2000
    for kind in KINDS:
        assert list(kind.seeds(1)) == [kind.first_seed]
        assert world_of(kind.first_seed + 1) == kind.draw(kind.first_seed + 1)
    assert world_of(3) == ordinary_world(3)


def test_crowds_are_learned_from_in_the_robot_s_own_span_too() -> None:
    assert with_library_span(crowded_world(5001)) == world_of(5001)
    assert len(world_of(5001)["people"]) > 4


def test_a_film_is_of_the_world_of_its_seed() -> None:
    gains = [
        parse_scenario(world_of(seed), source="world", folder=Path()).world(seed).robot.cameras[THERMAL].gain
        for seed in (1001, 3001)
    ]
    assert gains[0] != "fixed"
    assert gains[1] == "fixed"
