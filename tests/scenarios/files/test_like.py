from __future__ import annotations

from pathlib import Path

import pytest

from peopleboy.scenarios.files import load
from peopleboy.scenarios.files.load import load_scenario
from tests.helpers.calls.refused import refused

WHOLE = """
name: whole
description: A room.
duration_s: 2.0
place: {kind: room, length_m: 8.0, width_m: 6.0}
robot: {at_m: [1.0, 0.0]}
"""


@pytest.fixture
def shelf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(load, "LIBRARY", tmp_path)
    (tmp_path / "whole.yaml").write_text(WHOLE)
    for name, model in (("second", "whole"), ("third", "second"), ("here", "there"), ("there", "here")):
        text = f"name: {name}\ndescription: One more.\nlike: {model}\n"
        (tmp_path / f"{name}.yaml").write_text(text)
    return tmp_path


@pytest.mark.usefixtures("shelf")
def test_what_is_left_out_comes_from_farther_down_the_chain() -> None:
    third = load_scenario("third")
    assert (third.name, third.description, third.duration_s) == ("third", "One more.", 2.0)


@pytest.mark.usefixtures("shelf")
def test_a_scenario_that_is_like_itself_in_the_end_is_refused() -> None:
    with refused("'there'", "there, here"):
        load_scenario("here")


def test_an_unknown_one_is_refused_by_who_is_near_or_where_all_are_listed(tmp_path: Path) -> None:
    with refused("'crosing_2'", "did you mean 'crossing_2'?", "end in .yaml"):
        load_scenario("crosing_2")
    with refused("'zzz'", "`peopleboy list`"):
        load_scenario("zzz")
    path = tmp_path / "mine.yaml"
    path.write_text(WHOLE + "like: ./other.yaml\n")
    with refused("mine.yaml: like: ", "'./other.yaml'", "`peopleboy list`", "not a file"):
        load_scenario(path)
