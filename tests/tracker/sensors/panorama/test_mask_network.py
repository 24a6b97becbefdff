import gc
from dataclasses import asdict, replace
from io import BufferedReader

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.networks.mask_network import BLOCK, DILATIONS, INPUTS, OUTPUTS, MaskNetwork
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaView
from peopleboy.tracker.sensors.panorama.people_foreground import ForegroundModel
from tests.helpers.calls.refused import refused

ROWS, COLUMNS, UNITS = 10, 24, 12
VIEW = PanoramaView(
    width_px=COLUMNS * BLOCK, height_px=ROWS * BLOCK, centre_m=(1.7, 1.7), depression_deg=(8.0, 30.0, 55.0)
)


def drawn(*shape):
    return np.random.default_rng(len(shape)).normal(0, 0.2, shape).astype(np.float32)


@pytest.fixture(scope="module")
def network():
    return MaskNetwork(
        first=drawn(INPUTS, UNITS),
        rows=drawn(ROWS, UNITS),
        between=drawn(len(DILATIONS), 9, UNITS, UNITS),
        biases=drawn(len(DILATIONS), UNITS),
        last=drawn(UNITS + INPUTS, OUTPUTS),
        bias=drawn(OUTPUTS),
    )


def by_definition(network, squares):
    """The same with double precision and an index for every neighbour."""
    x = squares.transpose(1, 2, 0).astype(float)
    units = np.maximum(x @ network.first + network.rows[:, None], 0)
    for weights, bias, d in zip(network.between, network.biases, DILATIONS, strict=True):
        found = np.zeros_like(units)
        for row in range(ROWS):
            for k in range(9):
                source = row + (k // 3 - 1) * d
                if 0 <= source < ROWS:
                    found[row] += np.roll(units[source], -(k % 3 - 1) * d, axis=0) @ weights[k]
        units = units + np.maximum(found + bias, 0)
    reported = 1 / (1 + np.exp(-(np.concatenate([units, x], axis=2) @ network.last + network.bias)))
    return reported.reshape(ROWS, COLUMNS, BLOCK, BLOCK).transpose(0, 2, 1, 3).reshape(ROWS * BLOCK, -1)


def test_it_is_what_its_definition_says(network):
    squares = drawn(INPUTS, ROWS, COLUMNS)
    told = network.predict(squares)
    assert told.dtype == np.float32
    np.testing.assert_allclose(told, by_definition(network, squares), atol=1e-5)


@pytest.mark.parametrize("columns", [1, 5, 23])
def test_an_image_rolled_by_whole_squares_gives_the_same_answer_rolled_to_the_bit(network, columns):
    squares = drawn(INPUTS, ROWS, COLUMNS)
    rolled = network.predict(np.ascontiguousarray(np.roll(squares, columns, axis=2)))
    assert np.array_equal(rolled, np.roll(network.predict(squares), columns * BLOCK, axis=1))


def test_a_file_gives_back_what_was_written_and_the_same_bytes_each_time(network, tmp_path):
    model = ForegroundModel(network=network, view=VIEW, about={"trained on": "numbers drawn at random"})
    model.save(tmp_path / "a.npz")
    model.save(tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    read = ForegroundModel.load(tmp_path / "a.npz")
    assert (read.view, read.about) == (VIEW, model.about)
    for name, array in asdict(network).items():
        assert np.array_equal(getattr(read.network, name), array)


def test_a_file_that_is_no_network_is_refused(tmp_path):
    path = tmp_path / "model.npz"
    with refused("model.npz"):
        ForegroundModel.load(path)
    path.write_text("no arrays")
    with refused("model.npz", "not a file of weights"):
        ForegroundModel.load(path)
    np.savez(path, first=np.zeros(3, np.float32))
    with refused("model.npz", "not a file of weights", "peopleboy train foreground"):
        ForegroundModel.load(path)
    np.savez(path, about=np.array(["x"], dtype=object))
    with refused("model.npz", "not a file of weights"):
        ForegroundModel.load(path)


@pytest.mark.parametrize("kept", [0, 40, 0.5, -30], ids=["nothing", "head", "half", "no end"])
def test_a_damaged_file_is_refused_and_closed(network, tmp_path, kept):
    path = tmp_path / "model.npz"
    ForegroundModel(network=network, view=VIEW).save(path)
    whole = path.read_bytes()
    path.write_bytes(whole[: round(kept * len(whole)) if isinstance(kept, float) else kept])
    with pytest.raises(BadInput, match=r"model\.npz: not a file of weights") as caught:
        ForegroundModel.load(path)
    assert caught.value.__context__ is not None  # whose frames still have what they opened
    files = [one for one in gc.get_objects() if issubclass(type(one), BufferedReader)]
    assert [one for one in files if one.name == str(path) and not one.closed] == []


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bias": np.full(OUTPUTS, np.nan, np.float32)}, "bias must be finite float32 (16,)"),
        ({"first": np.zeros((INPUTS, UNITS))}, "got float64 (96, 12)"),
        ({"rows": np.zeros((ROWS - 1, UNITS), np.float32)}, "layers do not fit"),
        ({"rows": np.zeros((ROWS, 5), np.float32)}, "must be finite float32"),
    ],
)
def test_weights_that_do_not_fit_are_refused(network, tmp_path, change, words):
    path = tmp_path / "model.npz"
    ForegroundModel(network=replace(network, **change), view=VIEW).save(path)
    with refused("model.npz", words):
        ForegroundModel.load(path)
