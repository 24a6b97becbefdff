import itertools
from collections import Counter
from functools import cache

import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.people.appearance.traits import suit_age, usual_clothes
from peopleboy.sim.people.body.clothes import BOTTOMS, HAIR, SHOES, TOPS, Clothes
from peopleboy.sim.shapes.materials import COLOURS

DRAWS = 1000
WARM_TOPS = {"jacket", "fleece", "wool_jumper", "striped_jumper"}


@cache
def draws(sex: str, air_c: float) -> list[Clothes]:
    rng = stream(0, f"{sex} at {air_c}")
    return [usual_clothes(rng, sex, air_c) for _ in range(DRAWS)]


def share(clothes: list[Clothes], kind: str, *names: str) -> float:
    return sum(getattr(each, kind) in names for each in clothes) / len(clothes)


def test_hair_goes_by_sex() -> None:
    women, men = draws("female", 21.0), draws("male", 21.0)
    assert share(women, "hair", "bald") == 0.0
    # 7.7 % of men, of whom few wear a cap in a room.
    assert share(men, "hair", "bald") == pytest.approx(0.073, abs=0.02)
    assert share(women, "hair", "long") > 0.6 > 0.1 > share(men, "hair", "long") > 0.02
    assert share(women, "hair", "cap") == pytest.approx(0.05, abs=0.02)


@pytest.mark.parametrize("air_c", [0.0, 21.0, 30.0])
def test_no_man_wears_a_skirt_and_few_women_do(air_c: float) -> None:
    assert share(draws("male", air_c), "bottom", "skirt", "leggings") == 0.0
    assert 0.02 < share(draws("female", air_c), "bottom", "skirt") < 0.25


@pytest.mark.slow
@pytest.mark.parametrize("sex", ["female", "male"])
def test_people_dress_for_the_weather(sex: str) -> None:
    cold, room, warm = (draws(sex, air_c) for air_c in (2.0, 19.0, 32.0))
    assert share(cold, "top", *WARM_TOPS) > 0.9
    assert share(cold, "top", "jacket") == pytest.approx(0.72, abs=0.04)
    assert share(warm, "top", "t_shirt", "printed_t_shirt") == pytest.approx(0.76, abs=0.04)
    assert share(warm, "top", *WARM_TOPS) < 0.05 < share(room, "top", *WARM_TOPS) < 0.5
    assert share(cold, "bottom", "shorts") == 0.0
    assert share(room, "bottom", "shorts") < 0.04 < 0.2 < share(warm, "bottom", "shorts")
    assert share(cold, "shoes", "boots") > 0.45 > 0.05 > share(warm, "shoes", "boots")
    assert share(cold, "hair", "cap") == pytest.approx(0.4, abs=0.04)


def test_the_change_from_cold_to_warm_clothes_is_no_step() -> None:
    t_shirts = [share(draws("male", air_c), "top", "t_shirt") for air_c in (20.0, 23.0, 25.0, 27.0, 30.0)]
    assert t_shirts == sorted(t_shirts)
    assert max(b - a for a, b in itertools.pairwise(t_shirts)) < 0.2


def test_most_colours_are_muted_and_everything_is_in_the_catalogue() -> None:
    clothes = [*draws("female", 21.0), *draws("male", 21.0)]
    bright = share(clothes, "top_colour", "red", "orange", "yellow", "pink", "purple")
    assert 0.02 < bright < 0.12
    for kind, catalogue in (("top", TOPS), ("bottom", BOTTOMS), ("shoes", SHOES), ("hair", HAIR)):
        assert set(Counter(getattr(each, kind) for each in clothes)) <= set(catalogue)
    assert {each.hair_colour for each in clothes} <= set(COLOURS)
    assert all(each.hair_colour == "skin" for each in clothes if each.hair == "bald")


def test_no_child_is_bald_and_the_hair_of_elders_is_grey() -> None:
    rng = stream(0, "ages")
    worn = [usual_clothes(rng, "male", 21.0) for _ in range(300)]
    assert any(one.hair == "bald" for one in worn)
    assert not any(suit_age(one, "child").hair == "bald" for one in worn)
    hair = {suit_age(one, "elder").hair_colour for one in worn if one.hair in ("short", "long")}
    assert hair == {"grey", "light_grey"}
    assert all(suit_age(one, "adult") == one for one in worn)
