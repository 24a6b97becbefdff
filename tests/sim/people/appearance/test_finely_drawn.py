from dataclasses import replace

import numpy as np
import pytest

from peopleboy.sim.truth.truth import Box
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import config, person

PEOPLE = (
    person("ann", (3.5, -0.5), (7.0, 1.0), sex="female"),
    person("ben", (4.5, 0.6), (4.5, -1.2), bag=True),
)
PLAIN = config(*PEOPLE)
FULL: WorldConfig = replace(PLAIN, detail="full")


def play(settings: WorldConfig) -> list[tuple[dict[str, np.ndarray], np.ndarray, tuple[Box | None, ...]]]:
    """Images, each pixel's person, and boxes of four instants."""
    found = []
    with SimulatedWorld(settings) as world:
        for _ in range(4):
            world.step(0.0, 0.0)
            images = {name: image.copy() for name, image in dict(world.observe().images).items()}
            found.append(
                (
                    images,
                    world.truth().instance.copy(),
                    (world.box(1), world.box(2)),
                )
            )
    return found


def test_people_walk_the_same_way_and_look_otherwise() -> None:
    for (plain, cover, boxes), (full, again, boxes_again) in zip(play(PLAIN), play(FULL), strict=True):
        assert 0.02 < (again > 0).mean() < 0.5
        assert again[cover > 0].mean() > 0.8
        for one, other in zip(boxes, boxes_again, strict=True):
            assert one is not None
            assert other is not None
            assert one[1] == pytest.approx(other[1], abs=0.06 * (one[3] - one[1]))
            assert one[3] == pytest.approx(other[3], abs=0.06 * (one[3] - one[1]))
        is_person = (cover > 0) & (again > 0)
        assert (plain["colour"][is_person] != full["colour"][is_person]).any(axis=1).mean() > 0.5


def test_people_are_less_even_in_full_detail() -> None:
    (plain, cover, _), (full, _, _) = play(PLAIN)[-1], play(FULL)[-1]
    assert full["thermal_c"][cover > 0].std() > 1.1 * plain["thermal_c"][cover > 0].std()


@pytest.mark.slow
def test_the_seed_repeats_what_is_drawn_finely() -> None:
    one, again, other = (play(settings)[-1][0] for settings in (FULL, FULL, replace(FULL, seed=1)))
    assert all(np.array_equal(one[name], again[name]) for name in one)
    assert not np.array_equal(one["thermal_c"], other["thermal_c"])


@pytest.mark.parametrize("air_c", [0.0, pytest.param(30.0, marks=pytest.mark.thorough)])
def test_the_air_of_the_place_is_what_people_follow(air_c: float) -> None:
    (image, cover, _) = play(FULL)[-1]
    (other, _, _) = play(replace(FULL, place=replace(FULL.place, surroundings_c=air_c)))[-1]
    change = (other["thermal_c"] - image["thermal_c"])[cover > 0].mean()
    assert change * (air_c - 21.0) > 0.0
    assert 2.0 < abs(change) < abs(air_c - 21.0)
