"""Tests of the gallery of people: its file, what is refused, and who is recognised."""

import json
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.tracking.appearance import FEATURES, Colours
from peopleboy.tracker.tracking.config import ReidentificationConfig
from peopleboy.tracker.tracking.people_gallery import KnownPerson, PeopleGallery, read_gallery
from peopleboy.tracker.tracking.reidentification import known_person_log_odds


def colours(seed: int) -> Colours:
    shares = np.random.default_rng(seed).dirichlet(np.full(FEATURES, 0.02))
    return np.sqrt(shares).astype(np.float32)


def gallery() -> PeopleGallery:
    return PeopleGallery({3: KnownPerson(colours(3), 0.04, 1e-4), 1: KnownPerson(colours(1), -0.02, 2e-4)}, 6)


def saved(path: Path, **changes: object) -> Path:
    path.write_text(json.dumps(json.loads(gallery().to_text()) | changes), encoding="utf-8")
    return path


def test_a_file_gives_back_every_bit(tmp_path: Path) -> None:
    path = saved(tmp_path / "gallery.json")
    found, given = read_gallery(path), gallery()
    assert found.next_id == given.next_id
    assert found.people.keys() == given.people.keys()
    for number, one in given.people.items():
        assert found.people[number].colours.tobytes() == one.colours.tobytes()
        assert found.people[number][1:] == one[1:]
    assert found.to_text() == given.to_text()


def test_an_empty_gallery_has_a_file_too(tmp_path: Path) -> None:
    path = tmp_path / "gallery.json"
    path.write_text(PeopleGallery().to_text(), encoding="utf-8")
    assert read_gallery(path) == PeopleGallery()


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"format": "another"}, "is not a gallery of people"),
        ({"version": 2}, "is a gallery of format version 2"),
        ({"next_id": 3}, "is a damaged gallery"),
        ({"next_id": 2.5}, "is a damaged gallery"),
        ({"people": None}, "is a damaged gallery"),
        (
            {"people": [{"id": 1, "colours": [0.5], "build": 0.0, "build_variance": 0.1}]},
            "is a damaged gallery",
        ),
        ({"people": [{"id": 1}]}, "is a damaged gallery"),
        ({"people": [4]}, "is a damaged gallery"),
    ],
)
def test_another_file_is_refused_in_one_line(tmp_path: Path, changes: dict[str, object], fault: str) -> None:
    path = saved(tmp_path / "gallery.json", **changes)
    with pytest.raises(BadInput) as caught:
        read_gallery(path)
    assert str(caught.value).startswith(f"{path}: {fault}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY\x01", b"[1, 2]", gallery().to_text()[:-20].encode()])
def test_bytes_that_are_no_gallery_are_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "gallery.json"
    path.write_bytes(content)
    with pytest.raises(BadInput, match="is not a gallery of people"):
        read_gallery(path)


def test_a_person_of_unknown_place_is_recognised_by_colours_and_stature() -> None:
    known = gallery()
    assert known.absent({3}) == [1]
    people = known.candidates([3, 1])
    seen = people._replace(
        places_m=np.array([[2.0, 4.0], [-3.0, 9.0]]), variance_m2=np.tile(0.01 * np.eye(2), (2, 1, 1))
    )
    odds = known_person_log_odds(people, seen, ReidentificationConfig())
    assert (np.diag(odds) > 1.0).all()
    assert odds[0, 1] < 0.0
    assert odds[1, 0] < 0.0


def test_new_people_get_ids_after_all_known_ones() -> None:
    known = gallery()
    assert [known.take_id(), known.take_id()] == [6, 7]
