"""A user's mistake knows where it is, and says so in one place."""

import pickle

import pytest

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.files.load import parse_scenario


def test_a_mistake_says_file_key_and_reason() -> None:
    assert str(BadInput("too many")) == "too many"
    assert str(BadInput("too fast", key=("people", 0, "speed_m_s"))) == "people[0].speed_m_s: too fast"
    assert str(BadInput("it is empty", file="my.yaml")) == "my.yaml: it is empty"


def test_every_level_puts_its_steps_before_the_key() -> None:
    with pytest.raises(BadInput) as caught, found_in(file="my.yaml"), found_in("people", 2), found_in("path"):
        raise BadInput("outside the floor", key=(1, "at_m"))
    assert (caught.value.file, caught.value.key) == ("my.yaml", ("people", 2, "path", 1, "at_m"))
    assert str(caught.value) == "my.yaml: people[2].path[1].at_m: outside the floor"


def test_a_mistake_in_another_file_keeps_that_files_name() -> None:
    with pytest.raises(BadInput) as caught, found_in("like", file="my.yaml"):
        raise BadInput("must be a number", file="library/hall.yaml", key=("duration_s",))
    assert str(caught.value) == "my.yaml: like: library/hall.yaml: duration_s: must be a number"


def test_a_mistake_comes_whole_out_of_another_process() -> None:
    error = BadInput("too fast", file="my.yaml", key=("people", 0))
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.file, again.key) == (str(error), error.file, error.key)


def test_a_scenarios_mistake_has_its_key_as_data(tmp_path) -> None:
    data = {
        "name": "bad", "description": "A robot in a wall.", "duration_s": 2.0,
        "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0}, "robot": {"at_m": [0.1, 0.0]},
    }  # fmt: skip
    with pytest.raises(BadInput) as caught:
        parse_scenario(data, source="bad.yaml", folder=tmp_path)
    assert (caught.value.file, caught.value.key) == ("bad.yaml", ("robot", "at_m"))
    with pytest.raises(BadInput) as caught:
        parse_scenario(data | {"duration_s": -1}, source="bad.yaml", folder=tmp_path)
    assert (caught.value.file, caught.value.key) == ("bad.yaml", ("duration_s",))
