from collections import Counter
from dataclasses import asdict

import numpy as np
import pytest

from peopleboy.random_streams import stream
from peopleboy.sim.people.body.anthropometry import measure
from peopleboy.sim.people.body.body_shapes import BAG_PART, build_body
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.outfit import NOTHING_MORE, Outfit, draw_outfit, put_on
from peopleboy.sim.people.body_model import PART_CLASSES
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import Waypoint
from tests.helpers.worlds.individuals import make_individual
from tests.helpers.worlds.person_shapes import person_points
from tests.helpers.worlds.walkers import settle, walk

JACKET = Clothes(top="jacket", bottom="jeans", hair="long")
BARE = {
    "coat": "none", "leg_m": 0.0, "sleeve_m": 0.0, "hair_m": 0.0, "hairdo": "plain", "headgear": "none",
    "carried": "nothing",
}  # fmt: skip


def dressed(clothes: Clothes = JACKET, **outfit: object) -> Person:
    manner = {"holds": ("free", "free"), "leans": 0.0, "stoop_rad": 0.0}
    return make_individual(0, clothes=clothes, height_m=1.75, manner=manner, outfit=BARE | outfit)


def span(person: Person, *parts: str, axis: int = 1) -> float:
    return float(np.ptp(person_points(person, parts)[:, axis]))


def draws(clothes: Clothes, count: int = 1500, has_bag: bool = False) -> list[Outfit]:
    rng = stream(0, "outfits")
    return [draw_outfit(rng, clothes, "female", has_bag) for _ in range(count)]


def test_nothing_more_changes_no_part() -> None:
    size = measure(1.7, "female", "average")
    parts = build_body(size, "long", JACKET.thickness_m())
    assert put_on(parts, size, NOTHING_MORE, JACKET.thickness_m()) == parts


def test_coats_cover_what_they_hang_over_and_end_straight() -> None:
    short, hip, long = (dressed(coat=coat) for coat in ("none", "hip", "long"))
    assert [len(each.model.parts) for each in (short, hip, long)] == [len(short.model.parts)] * 3
    low = [person_points(each, ["pelvis"])[:, 2].min() for each in (short, hip)]
    assert low[1] > low[0] - 0.06
    assert span(long, "left_thigh", "right_thigh") > span(short, "left_thigh", "right_thigh") + 0.01
    materials = {part.name: part.material for part in long.model.parts}
    assert materials["left_thigh"].rgb == materials["chest"].rgb == materials["pelvis"].rgb
    assert materials["left_shin"].rgb != materials["chest"].rgb


def test_wide_legs_and_sleeves_are_as_wide_as_said() -> None:
    person = dressed(leg_m=0.09, sleeve_m=0.07)
    assert span(person, "left_shin", axis=1) == pytest.approx(0.18, abs=0.025)
    low = person_points(person, ["left_shin"])[:, 2].min()
    assert 0.0 < low < 0.09


def test_hair_stands_off_and_hoods_cover_it() -> None:
    short = Clothes(top="jacket", hair="short")
    flat, thick, hood = dressed(short), dressed(short, hair_m=0.03), dressed(headgear="hood")
    assert span(thick, "hair") == pytest.approx(span(flat, "hair") + 0.06, abs=0.012)
    assert person_points(thick)[:, 2].max() == pytest.approx(1.765, abs=0.02)
    materials = {part.name: part.material for part in hood.model.parts}
    assert materials["hair"].rgb == materials["chest"].rgb


@pytest.mark.parametrize("side", ["left", "right"])
def test_what_is_carried_is_behind_beside_or_below(side: str) -> None:
    sign = 1.0 if side == "left" else -1.0
    at = {}
    for carried in ("rucksack", "shoulder_bag", "shopping_bag"):
        person = dressed(carried=carried, side=side)
        assert [part.name for part in person.model.parts][-1] == BAG_PART
        at[carried] = person_points(person, [BAG_PART])
    assert at["rucksack"][:, 0].max() < 0.02
    assert abs(at["rucksack"][:, 1].mean()) < 0.02
    assert (sign * at["shoulder_bag"][:, 1]).min() > 0.08
    assert 0.0 < at["shopping_bag"][:, 2].min() < at["shopping_bag"][:, 2].max() < 0.85


def test_what_is_carried_goes_along_and_is_of_the_person() -> None:
    path = (Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(9.0, 0.0)))
    person = make_individual(0, path=path, outfit={"carried": "rucksack"})
    for _ in walk(settle(person, 1.0), 2.0, start=1.0):
        assert 0.05 < person.position[0] - person.poses()[-1][0, 3] + 0.3 < 0.6
    assert {part.name for part in person.model.parts} <= PART_CLASSES.keys()


def test_outfits_are_as_frequent_as_said_and_fit_the_clothes() -> None:
    jackets, shirts = draws(JACKET), draws(Clothes(top="t_shirt", bottom="shorts", hair="bald"))
    coats = Counter(each.coat for each in jackets)
    assert coats["long"] / len(jackets) == pytest.approx(0.3, abs=0.04)
    assert not any(each.coat == "long" or each.headgear == "hood" for each in shirts)
    assert not any(each.leg_m or each.hair_m or each.sleeve_m for each in shirts)
    carried = Counter(each.carried for each in shirts)
    assert carried["nothing"] / len(shirts) == pytest.approx(0.52, abs=0.04)
    assert all(each.carried == "nothing" for each in draws(JACKET, 100, has_bag=True))


def test_the_same_stream_draws_the_same_outfits() -> None:
    assert [asdict(each) for each in draws(JACKET, 20)] == [asdict(each) for each in draws(JACKET, 20)]
