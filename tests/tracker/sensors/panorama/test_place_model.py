from dataclasses import asdict, replace
from itertools import pairwise

import numpy as np
import pytest

from peopleboy.tracker.networks.inference import DenseNetwork
from peopleboy.tracker.networks.weights_archive import WeightsArchive
from peopleboy.tracker.sensors.panorama.figure_patch import PATCH
from peopleboy.tracker.sensors.panorama.place_model import (
    INPUTS,
    PlaceModel,
    with_distance,
)
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.calls.refused import refused
from tests.helpers.images.cardboard import CAMERA, VIEW


def network(seed, outputs, units=(7,)):
    rng = np.random.default_rng(seed)
    widths = [INPUTS, *units, outputs]
    return DenseNetwork(
        [
            (rng.normal(0, 0.1, (here, there)).astype(np.float32), rng.normal(0, 1, there).astype(np.float32))
            for here, there in pairwise(widths)
        ]
    )


OUTPUTS = ("presence", "place", "doubt")
MODEL = PlaceModel(
    presence=network(1, 1),
    place=network(2, 2, (9, 4)),
    doubt=network(3, 2),
    view=VIEW,
    about={"trained on": "drawn numbers"},
)


def patches(number):
    rng = np.random.default_rng(number)
    return rng.uniform(0, 1, (number, PATCH)).astype(np.float32), rng.uniform(0.8, 9.0, number)


def test_a_network_is_sums_cut_off_below_zero_between_its_layers():
    inputs = np.random.default_rng(0).normal(0, 1, (5, INPUTS)).astype(np.float32)
    for reported, row in zip(MODEL.place.predict(inputs), inputs.astype(float), strict=True):
        units = row
        for number, (weights, bias) in enumerate(MODEL.place.layers):
            if number:
                units = [max(unit, 0.0) for unit in units]
            units = [
                sum(u * w for u, w in zip(units, column, strict=True)) + b
                for column, b in zip(weights.T.astype(float), bias, strict=True)
            ]
        np.testing.assert_allclose(reported, units, rtol=1e-4, atol=1e-4)


def test_places_are_read_each_for_itself():
    shown, distance = patches(6)
    reported = MODEL.look(shown, distance)
    assert reported.evidence.shape == (6,)
    assert reported.offset_m.shape == reported.deviation_m.shape == (6, 2)
    assert (reported.deviation_m > 0).all()
    for k in range(6):
        alone = MODEL.look(shown[k : k + 1], distance[k : k + 1])
        for one, all_of_them in ((alone.evidence, reported.evidence), (alone.offset_m, reported.offset_m)):
            np.testing.assert_allclose(one[0], all_of_them[k], rtol=1e-4, atol=1e-4)


def test_distances_are_told_by_their_inverse_and_as_a_share():
    inputs = with_distance(np.zeros((3, PATCH), np.float32), np.array([1.0, 4.0, 20.0]))
    assert inputs.dtype == np.float32
    np.testing.assert_allclose(inputs[:, -2:], [[1.0, 0.125], [0.25, 0.5], [0.05, 1.0]])


def test_a_file_gives_back_what_was_written_and_the_same_bytes_each_time(tmp_path):
    for name in ("a.npz", "b.npz"):
        MODEL.save(tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    read = PlaceModel.load(tmp_path / "a.npz")
    assert (read.view, read.about) == (VIEW, MODEL.about)
    shown, distance = patches(4)
    ours, theirs = MODEL.look(shown, distance), read.look(shown, distance)
    for one, other in (
        (ours.evidence, theirs.evidence),
        (ours.offset_m, theirs.offset_m),
        (ours.deviation_m, theirs.deviation_m),
    ):
        assert np.array_equal(one, other)


def arrays():
    return {
        f"{name}.{number}.{part}": array
        for name in OUTPUTS
        for number, layer in enumerate(getattr(MODEL, name).layers)
        for part, array in zip(("weights", "bias"), layer, strict=True)
    }


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"place.0.weights": np.zeros((INPUTS + 1, 9), np.float32)}, "place"),
        ({"place.1.bias": np.zeros(5, np.float32)}, "place"),
        ({"doubt.1.weights": np.zeros((7, 3), np.float32), "doubt.1.bias": np.zeros(3, np.float32)}, "doubt"),
        ({"presence.0.bias": None}, "presence.0.bias"),
        ({"presence.0.weights": None}, "presence"),
        ({f"presence.{k}.{part}": None for k in range(2) for part in ("weights", "bias")}, "presence"),
        ({"place.0.weights": np.full((INPUTS, 9), np.nan, np.float32)}, "place.0.weights"),
    ],
)
def test_layers_that_do_not_fit_are_refused(tmp_path, change, words):
    changed = {name: array for name, array in (arrays() | change).items() if array is not None}
    WeightsArchive(changed, camera=asdict(VIEW)).save(tmp_path / "places.npz")
    with refused("places.npz", words):
        PlaceModel.load(tmp_path / "places.npz")


def test_what_comes_with_the_tracker_holds_for_the_usual_mirror():
    model = PlaceModel.load()
    assert model.view.refusal(VIEW) == ""
    assert model.view.refusal(replace(VIEW, centre_m=(1.5, 1.5)))
    assert [getattr(model, name).layers[-1][1].size for name in OUTPUTS] == [1, 2, 2]
    for name in ("panoramic", "handover"):
        make_tracker(name).check_cameras({"panorama": CAMERA})
