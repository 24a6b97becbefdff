from __future__ import annotations

from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml


def refusal(folder: Path, text: str | bytes) -> str:
    path = folder / "bad.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(BadInput) as caught:
        load_scenario(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message


LAUGHS = "a: &a [x, x, x, x]\n" + "".join(
    f"{new}: &{new} [*{old}, *{old}, *{old}, *{old}]\n"
    for old, new in zip("abcdefgh", "bcdefghi", strict=True)
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "the file is empty"),
        ("# nothing but a remark\n", "the file is empty"),
        ("- a\n- b\n", "it holds a list, not keys"),
        ("just words\n", "it holds a str, not keys"),
        ("name: a\nname: b\n", "line 2: key 'name' is given twice"),
        ("place: {kind: room, kind: corridor}\n", "line 1: key 'kind' is given twice"),
        ("name: !!python/object/apply:os.system ['true']\n", "line 1: tag 'tag:yaml.org,2002:python/object"),
        (
            "!!python/object:sim.place.Place {}\n",
            "line 1: tag 'tag:yaml.org,2002:python/object",
        ),
        ("duration_s: !!int ''\n", "tag 'tag:yaml.org,2002:int' is not allowed; write the plain value"),
        ("duration_s: !own 3\n", "tag '!own' is not allowed"),
        ("duration_s: " + "9" * 5000 + "\n", "not YAML: "),
        (LAUGHS, "line 2: alias '*a' is not allowed"),
        ("a: &a [*a]\n", "alias '*a' is not allowed"),
        ("name: [1, 2\nrobot: 3\n", "line 2: "),
        ("name: 'a\n", "line "),
        ("? [a, b]\n: c\n", "line 1: a key must be a word"),
        ("a: " + "[" * 5000 + "\n", "nested too deeply"),
        ("a: \x00\n", "not YAML: unacceptable character"),
        (b"name: \xff\xfe\n", "it is not UTF-8 text"),
        ("x: " + "y" * 1_000_001, "a scenario file has at most 1000000"),
        ("name: a\n---\nname: b\n", "line 2: but found another document"),
    ],
)
def test_a_file_that_is_no_plain_yaml_mapping_is_refused(
    tmp_path: Path, text: str | bytes, expected: str
) -> None:
    assert expected in refusal(tmp_path, text)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"nothing\.yaml: there is no such file"):
        load_scenario(tmp_path / "nothing.yaml")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="it is a folder"):
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
