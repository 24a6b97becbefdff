import numpy as np
import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.traits import Traits, draw_traits
from peopleboy.sim.people.body.outfit import NOTHING_MORE, Outfit
from peopleboy.sim.people.person_config import PersonConfig, Waypoint


def people(
    air_c: float = 21.0, speed: float = 1.2, outfit: Outfit = NOTHING_MORE, **settings: object
) -> list[Traits]:
    path = (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(9.0, 0.0), speed_m_s=speed))
    config = PersonConfig(name="ann", path=path, **settings)
    rng = stream(0, "looks")
    return [draw_traits(config, outfit, air_c, rng) for _ in range(2000)]


def mean(traits: list[Traits], name: str) -> float:
    return float(np.mean([getattr(each, name) for each in traits]))


def test_a_third_wear_glasses_and_no_woman_a_beard() -> None:
    women, men = people(sex="female"), people(sex="male")
    assert mean(women, "glasses") == pytest.approx(0.36, abs=0.03)
    assert mean(men, "beard") == pytest.approx(0.35, abs=0.03)
    assert not any(each.beard for each in women)


def test_who_walks_fast_is_warmer_and_warm_air_makes_sweat() -> None:
    slow, usual, fast = (people(speed=speed) for speed in (0.7, 1.2, 1.9))
    assert mean(usual, "warmer_k") == pytest.approx(0.0, abs=0.05)
    assert mean(fast, "warmer_k") > mean(slow, "warmer_k") + 1.0
    assert mean(people(33.0), "sweat") > 0.5 > 0.2 > mean(usual, "sweat")


def test_cold_hands_go_with_cold_noses() -> None:
    found = np.array([(each.hands_k, each.nose_k) for each in people()])
    assert np.corrcoef(found.T)[0, 1] > 0.5
    assert found.std(axis=0).min() > 0.5


def test_straps_come_from_the_shoulders_that_bags_hang_from() -> None:
    def strap(carried: str) -> str:
        return people(outfit=Outfit(carried=carried, side="right"))[0].strap

    assert [strap(each) for each in ("rucksack", "shoulder_bag", "shopping_bag")] == ["both", "left", "none"]
