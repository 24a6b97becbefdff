from dataclasses import replace
from pathlib import Path

import pytest

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario

PATH, BESIDE, BEYOND = ([{"at_m": [x, 1.0]}, {"at_m": [x, -1.0]}] for x in (4.0, 5.0, 6.0))


def scenario(detail: str, surroundings_c: float = 21.0) -> Scenario:
    people = [
        {"name": "ann", "sex": "female", "path": PATH},
        {"name": "ben", "sex": "male", "clothes": {"top": "lab_coat", "bottom": "skirt"}, "path": BESIDE},
        {"name": "cleo", "path": BEYOND},
    ]
    place = {
        "kind": "room",
        "length_m": 9.0,
        "width_m": 8.0,
        "temperatures": {"surroundings_c": surroundings_c},
    }
    data = {"name": "some", "description": "Some.", "duration_s": 5.0, "detail": detail, "place": place}
    return parse_scenario(
        data | {"people": people, "robot": {"at_m": [0.8, 0.0]}}, source="some.yaml", folder=Path("/nowhere")
    )


def test_full_detail_changes_clothes_and_no_other_draw() -> None:
    for seed in range(10):
        plain, full = scenario("plain").people(seed), scenario("full").people(seed)
        for before, after in zip(plain, full, strict=True):
            assert replace(before, clothes=None) == replace(after, clothes=None)


def test_what_the_file_says_is_worn_and_the_rest_is_usual() -> None:
    for seed in range(40):
        ann, ben, _ = scenario("full").people(seed)
        assert ann.clothes["hair"] != "bald"
        assert (ben.clothes["top"], ben.clothes["bottom"]) == ("lab_coat", "skirt")


@pytest.mark.parametrize(
    ("air_c", "tops"), [(0.0, {"jacket", "fleece"}), (33.0, {"t_shirt", "printed_t_shirt"})]
)
def test_people_dress_for_the_air_of_the_place(air_c: float, tops: set[str]) -> None:
    worn = [scenario("full", air_c).people(seed)[0].clothes["top"] for seed in range(40)]
    assert sum(top in tops for top in worn) > 25


def test_a_resolved_scenario_casts_the_same_people() -> None:
    full = scenario("full")
    data = full.resolved(3)
    again = parse_scenario(data, source="some.yaml", folder=Path("/nowhere"))
    assert again.people(3) == full.people(3)
