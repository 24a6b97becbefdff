"""The distribution of rendered random worlds can be narrowed by a file and by options."""

from __future__ import annotations

from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.export.make_dataset import SetOptions
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.random_worlds.distribution import SHARES, narrowed
from peopleboy.scenarios.random_worlds.random_world import random_world


def test_options_override_the_file_and_the_rest_stays(tmp_path: Path) -> None:
    file = tmp_path / "own.yaml"
    file.write_text("place: {room: 1, street: 3}\npeople: [1, 3]\npitch: 2\n", encoding="utf-8")
    options = SetOptions(random_worlds=True, distribution=file, pitch_deg=(5.0, 10.0), seeds=range(3))
    found = options.contents().distribution
    assert found is not None
    assert found.shares["place"] == {"room": 0.25, "street": 0.75}
    assert (found.ranges["people"].low, found.ranges["people"].high) == (1, 3)
    assert (found.ranges["pitch"].low, found.ranges["pitch"].high) == (5.0, 10.0)
    assert found.odds == narrowed({}).odds
    asked = options.asked(options.contents())
    assert asked == ("--random-worlds", "--distribution", str(file), "--pitch-deg", "5.0", "10.0")


@pytest.mark.parametrize(("only", "kinds"), [("rooms", 1), ("corridors", 3), ("streets", 1)])
def test_only_one_kind_of_place_keeps_its_proportions(only: str, kinds: int) -> None:
    contents = SetOptions(random_worlds=True, only=only).contents()  # type: ignore[arg-type]
    assert contents.distribution is not None
    places = contents.distribution.shares["place"]
    assert len(places) == kinds
    assert sum(places.values()) == pytest.approx(1.0)
    assert len({round(share / SHARES["place"][name], 9) for name, share in places.items()}) == 1


VARIED = {
    "bodies": "skins",
    "age": ["adult", "child", "elder"],
    "gait": {"usual": 1, "running": 1, "old": 1},
    "equipment": {"nothing": 1, "bicycle": 1, "trolley": 1, "wheelchair": 1},
    "posture": ["lying", "crouching"],
    "pauses": 0.8,
    "people": [5, 10],
    "things": 0,
}


def test_several_values_keep_their_proportions_unless_one_is_never_drawn_by_default() -> None:
    given = {"age": ["adult", "elder"], "posture": "sitting", "bodies": ["skins", "capsules"]}
    found = narrowed(given).shares
    assert found["age"] == pytest.approx({"adult": 5 / 6, "elder": 1 / 6})
    assert found["posture"] == {"sitting": 1.0}
    assert found["bodies"] == {"skins": 0.5, "capsules": 0.5}


def test_people_of_all_kinds_are_drawn_where_the_distribution_has_them() -> None:
    worlds = [random_world(seed, distribution=narrowed(VARIED)) for seed in range(6)]
    people = [person for world in worlds for person in world.get("people", ())]
    for key, values in {
        "age": {"adult", "child", "elder"},
        "gait": {"usual", "running", "old"},
        "equipment": {"nothing", "bicycle", "trolley", "wheelchair"},
    }.items():
        usual = {"age": "adult", "gait": "usual", "equipment": "nothing"}[key]
        assert {person.get(key, usual) for person in people} == values
    assert {world["bodies"] for world in worlds} == {"skins"}
    for world in worlds:
        parse_scenario(world, source="world", folder=Path())
    for person in people:
        if person.get("gait") == "running" and "equipment" not in person:
            assert min(point["speed_m_s"] for point in person["path"]) >= 1.6


def test_kinds_of_people_do_not_change_anything_else_of_a_world() -> None:
    alike = {"age": "adult", "gait": "usual", "equipment": "nothing", "pauses": 0.0}
    plain, varied = (
        random_world(4, distribution=narrowed(alike | given)) for given in ({}, {"age": "elder"})
    )
    assert [person | {"age": "elder"} for person in plain["people"]] == varied["people"]
    assert {key: value for key, value in plain.items() if key != "people"} == {
        key: value for key, value in varied.items() if key != "people"
    }


@pytest.mark.parametrize(
    ("content", "printed"),
    [
        ("peple: 3\n", "peple: unknown name; did you mean 'people'"),
        ("place: {attic: 1}\n", "unknown value 'attic'"),
        ("place: {room: -1}\n", "weights of 0 or more"),
        ("place: {room: 0}\n", "a weight above 0"),
        ("pitch: [0, 40]\n", "within -15 .. 15 deg"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(tmp_path: Path, content: str, printed: str) -> None:
    file = tmp_path / "own.yaml"
    file.write_text(content, encoding="utf-8")
    with pytest.raises(BadInput, match=r"own\.yaml") as refused:
        SetOptions(random_worlds=True, distribution=file).contents()
    assert printed in str(refused.value)
    assert "\n" not in str(refused.value)


def test_options_of_random_worlds_are_refused_for_scenarios() -> None:
    with pytest.raises(BadInput, match="--only: applies to random worlds"):
        SetOptions(scenarios=("crossing_2",), only="rooms").contents()
