import json
from dataclasses import asdict

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.panoramic.weights_file import ABOUT, VIEW, Weights
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images import cardboard

COMMAND = "peopleboy train-something"
SOME = Weights(
    {"a": np.arange(6, dtype=np.float32).reshape(2, 3), "b": np.zeros(1, np.float32)},
    cardboard.VIEW,
    {"from": "numbers", "with": "µ"},
)


def test_a_file_gives_back_arrays_camera_and_words(tmp_path):
    SOME.save(tmp_path / "weights.npz")
    read = Weights.load(tmp_path / "weights.npz", COMMAND)
    assert read.view == SOME.view
    assert read.about == SOME.about
    assert set(read.arrays) == {"a", "b"}
    assert all(np.array_equal(read.arrays[name], array) for name, array in SOME.arrays.items())


def test_a_name_without_ending_stays_so(tmp_path):
    SOME.save(tmp_path / "weights")
    assert [path.name for path in tmp_path.iterdir()] == ["weights"]


def test_a_file_that_is_missing_is_told_with_what_makes_one(tmp_path):
    with refused("weights.npz", "cannot be read", COMMAND):
        Weights.load(tmp_path / "weights.npz", COMMAND)
    with refused(tmp_path.name, "cannot be read", COMMAND):
        Weights.load(tmp_path, COMMAND)


def whole(path):
    SOME.save(path)
    return path.read_bytes()


@pytest.mark.parametrize(
    "damage",
    [
        lambda _: b"",
        lambda _: b"no archive at all",
        lambda found: found[:40],
        lambda found: found[: len(found) // 2],
        lambda found: found[:-30],
        lambda found: found.replace(b"camera.npy", b"camero.npy"),
    ],
    ids=["empty", "text", "head", "half", "no end", "no camera"],
)
def test_a_damaged_file_is_refused(tmp_path, damage):
    path = tmp_path / "weights.npz"
    path.write_bytes(damage(whole(path)))
    with refused("weights.npz", COMMAND):
        Weights.load(path, COMMAND)


@pytest.mark.parametrize("bit", [1, 64])
def test_a_file_with_a_wrong_bit_is_refused_or_says_the_same(tmp_path, bit):
    path, good = tmp_path / "weights.npz", whole(tmp_path / "good.npz")
    for place in range(0, len(good), 3):
        path.write_bytes(good[:place] + bytes([good[place] ^ bit]) + good[place + 1 :])
        try:
            read = Weights.load(path, COMMAND)
        except BadInput as error:
            assert_names(str(error), "weights.npz")
        else:
            assert read.view == SOME.view
            assert all(np.array_equal(array, SOME.arrays[name]) for name, array in read.arrays.items())


@pytest.mark.parametrize(
    "arrays",
    [
        {"a": np.zeros(3)},
        {"a": np.array([1.0, np.inf], np.float32)},
        {"a": np.zeros(3, np.int64)},
    ],
)
def test_numbers_that_are_no_finite_float32_are_refused(tmp_path, arrays):
    path = tmp_path / "weights.npz"
    words = {VIEW: np.array(json.dumps(asdict(cardboard.VIEW))), ABOUT: np.array("{}")}
    np.savez(path, **words, **arrays)
    with refused("weights.npz", "a must be finite float32"):
        Weights.load(path, COMMAND)


@pytest.mark.parametrize("view", ['"wide"', "{}", "[1, 2]", '{"width_px": 480}', "no json", "null"])
def test_a_camera_that_is_none_is_refused(tmp_path, view):
    path = tmp_path / "weights.npz"
    np.savez(path, **{VIEW: np.array(view), ABOUT: np.array("{}"), "a": np.zeros(2, np.float32)})
    with refused("weights.npz", COMMAND):
        Weights.load(path, COMMAND)


def test_objects_in_a_file_are_never_made(tmp_path):
    path = tmp_path / "weights.npz"
    np.savez(path, **{VIEW: np.array([print], dtype=object), ABOUT: np.array("{}")})
    with refused("weights.npz", COMMAND):
        Weights.load(path, COMMAND)
