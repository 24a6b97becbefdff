from __future__ import annotations

from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from tests.helpers.calls.refused import assert_names, refused


def refusal(folder: Path, text: str | bytes) -> str:
    path = folder / "bad.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(BadInput) as caught:
        load_scenario(path)
    assert_names(str(caught.value), f"{path}: ")
    return str(caught.value)


LAUGHS = "a: &a [x, x, x, x]\n" + "".join(
    f"{new}: &{new} [*{old}, *{old}, *{old}, *{old}]\n"
    for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("name: x\n\tduration_s: 2", ("line 2: a tab", "indent with spaces")),
        ("", ("empty",)),
        ("# nothing but a remark\n", ("empty",)),
        ("- a\n- b\n", ("list",)),
        ("just words\n", ("str",)),
        ("name: a\nname: b\n", ("line 2: ", "'name'")),
        ("place: {kind: room, kind: corridor}\n", ("line 1: ", "'kind'")),
        (
            "name: !!python/object/apply:os.system ['true']\n",
            ("line 1: ", "'tag:yaml.org,2002:python/object"),
        ),
        (
            "!!python/object:sim.place.Place {}\n",
            ("line 1: ", "'tag:yaml.org,2002:python/object"),
        ),
        ("duration_s: !!int ''\n", ("'tag:yaml.org,2002:int'",)),
        ("duration_s: !own 3\n", ("'!own'",)),
        ("duration_s: " + "9" * 5000 + "\n", ("YAML",)),
        (LAUGHS, ("line 2: ", "'*a'")),
        ("a: &a [*a]\n", ("'*a'",)),
        ("name: [1, 2\nrobot: 3\n", ("line 2: ",)),
        ("name: 'a\n", ("line ",)),
        ("? [a, b]\n: c\n", ("line 1: ", "key")),
        ("a: " + "[" * 5000 + "\n", ("deep",)),
        ("a: \x00\n", ("YAML", "character")),
        (b"name: \xff\xfe\n", ("UTF-8",)),
        ("x: " + "y" * 1_000_001, ("1000000",)),
        ("name: a\n---\nname: b\n", ("line 2: ",)),
    ],
)
def test_a_file_that_is_no_plain_yaml_mapping_is_refused(
    tmp_path: Path, text: str | bytes, named: tuple[str, ...]
) -> None:
    assert_names(refusal(tmp_path, text), *named)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with refused(tmp_path / "nothing.yaml"):
        load_scenario(tmp_path / "nothing.yaml")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with refused(tmp_path, "folder"):
        load_scenario(tmp_path)


def test_only_true_and_false_are_booleans_and_dates_stay_text(tmp_path: Path) -> None:
    path = tmp_path / "words.yaml"
    path.write_text("a: no\nb: on\nc: true\nd: 2024-01-01\non: yes\ne: 1.5\nf: False\n")
    assert read_yaml(path) == {
        "a": "no",
        "b": "on",
        "c": True,
        "d": "2024-01-01",
        "on": "yes",
        "e": 1.5,
        "f": False,
    }


def test_numbers_are_those_of_people_not_octal_ones_or_those_of_clocks(tmp_path: Path) -> None:
    path = tmp_path / "numbers.yaml"
    path.write_text(
        "whole: [0, -7, +45, 120]\nbroken: [0.5, -.5, 3., 1e3, 2.5E-1, -0.0, .inf]\n"
        "text: [045, '45', 1:30, 0x10, 1_000, 0b1, 1:30.5, e3, '.', '-']\n"
    )
    read = read_yaml(path)
    assert read["whole"] == [0, -7, 45, 120]
    assert all(isinstance(value, int) for value in read["whole"])
    assert read["broken"] == [0.5, -0.5, 3.0, 1000.0, 0.25, 0.0, float("inf")]
    assert all(isinstance(value, str) for value in read["text"])
