import json
from dataclasses import asdict

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.networks.weights_archive import SHIPPED, ArraySpec, WeightsArchive
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaView
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images import cardboard

COMMAND = "peopleboy train something"
SPECS = {"a": ArraySpec((2, "n")), "b": ArraySpec((1,))}
SOME = WeightsArchive(
    {"a": np.arange(6, dtype=np.float32).reshape(2, 3), "b": np.zeros(1, np.float32)},
    {"from": "numbers", "with": "µ"},
    asdict(cardboard.VIEW),
)


def load(path, specs=SPECS):
    return WeightsArchive.load(path, "something", specs, PanoramaView.of_plain)


def test_a_file_gives_back_arrays_camera_and_words(tmp_path):
    SOME.save(tmp_path / "weights.npz")
    read = load(tmp_path / "weights.npz")
    assert read.camera == cardboard.VIEW
    assert read.about == SOME.about
    assert set(read.arrays) == {"a", "b"}
    assert all(np.array_equal(read.arrays[name], array) for name, array in SOME.arrays.items())


def test_a_name_without_ending_stays_so(tmp_path):
    SOME.save(tmp_path / "weights")
    assert [path.name for path in tmp_path.iterdir()] == ["weights"]


def test_a_file_that_is_missing_is_told_with_what_makes_one(tmp_path):
    with refused("weights.npz", "cannot be read", COMMAND):
        load(tmp_path / "weights.npz")
    with refused(tmp_path.name, "cannot be read", COMMAND):
        load(tmp_path)


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
        load(path)


@pytest.mark.parametrize("bit", [1, 64])
def test_a_file_with_a_wrong_bit_is_refused_or_says_the_same(tmp_path, bit):
    path, good = tmp_path / "weights.npz", whole(tmp_path / "good.npz")
    for place in range(0, len(good), 3):
        path.write_bytes(good[:place] + bytes([good[place] ^ bit]) + good[place + 1 :])
        try:
            read = load(path)
        except BadInput as error:
            assert_names(str(error), "weights.npz")
        else:
            assert read.camera == cardboard.VIEW
            assert all(np.array_equal(array, SOME.arrays[name]) for name, array in read.arrays.items())


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"a": np.zeros((2, 3))}, "a must be finite float32 (2, n), got float64 (2, 3)"),
        ({"a": np.array([[1.0], [np.inf]], np.float32)}, "a must be finite float32"),
        ({"a": np.zeros((3, 2), np.float32)}, "got float32 (3, 2)"),
        ({"a": np.zeros((2, 0), np.float32)}, "a must be"),
        ({"b": None}, "has no b"),
    ],
)
def test_arrays_that_are_not_as_specified_are_refused(tmp_path, arrays, words):
    changed = {name: array for name, array in (dict(SOME.arrays) | arrays).items() if array is not None}
    WeightsArchive(changed, camera=SOME.camera).save(tmp_path / "weights.npz")
    with refused("weights.npz", words, COMMAND):
        load(tmp_path / "weights.npz")


def test_sizes_of_the_same_name_agree(tmp_path):
    specs = {"a": ArraySpec((2, "n")), "b": ArraySpec(("n",))}
    SOME.save(tmp_path / "weights.npz")
    with refused("weights.npz", "b must be finite float32 (n,), got float32 (1,)"):
        load(tmp_path / "weights.npz", specs)


def test_infinite_numbers_pass_where_they_may_and_nan_never_does(tmp_path):
    spec = {"a": ArraySpec((2,), may_be_infinite=True)}
    for last, is_refused in ((np.inf, False), (np.nan, True)):
        archive = WeightsArchive({"a": np.array([0.0, last], np.float32)}, camera=SOME.camera)
        archive.save(tmp_path / "weights.npz")
        if is_refused:
            with refused("weights.npz", "a must be float32 (2,)"):
                load(tmp_path / "weights.npz", spec)
        else:
            load(tmp_path / "weights.npz", spec)


@pytest.mark.parametrize("path", sorted(SHIPPED.iterdir()), ids=lambda path: path.name)
def test_shipped_weights_say_what_they_were_trained_on_and_hold_no_objects(path):
    with np.load(path, allow_pickle=False) as archive:
        assert json.loads(str(archive["about"]))
        assert all(archive[name].dtype != object for name in archive)


@pytest.mark.parametrize("view", ['"wide"', "{}", "[1, 2]", '{"width_px": 480}', "no json", "null"])
def test_a_camera_that_is_none_is_refused(tmp_path, view):
    path = tmp_path / "weights.npz"
    np.savez(path, camera=np.array(view), about=np.array("{}"), a=np.zeros(2, np.float32))
    with refused("weights.npz", COMMAND):
        load(path)


def test_objects_in_a_file_are_never_made(tmp_path):
    path = tmp_path / "weights.npz"
    np.savez(path, camera=np.array([print], dtype=object), about=np.array("{}"))
    with refused("weights.npz", COMMAND):
        load(path)
