from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from peopleboy.tracker.networks.convolution import Workspace, convolve
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.sensors.thermal.detector.crops import CHANNELS
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork, RescoringNetwork
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_crops import drawn_weights

KINDS = pytest.mark.parametrize("kind", [RescoringNetwork, BoxRefinementNetwork])


def drawn_network(kind: type[CropNetwork]) -> CropNetwork:
    line = {"line": np.array([1.0, 0.0], np.float32)} if "line" in kind.shapes() else {}
    return kind(drawn_weights(kind.ARCHITECTURE) | line, {"trained on": "nothing"})


@pytest.mark.parametrize("shipped", [RescoringNetwork.shipped(), BoxRefinementNetwork.shipped()])
@pytest.mark.parametrize("count", [1, 4, 7])
def test_what_is_told_does_not_hang_on_how_many_threads_there_are(shipped: CropNetwork, count: int) -> None:
    rng = np.random.default_rng(count)
    rows, columns, _ = shipped.ARCHITECTURE.crop
    planes = rng.standard_normal((count, rows, columns, CHANNELS)).astype(np.float32)
    numbers = rng.standard_normal((count, shipped.ARCHITECTURE.features)).astype(np.float32)
    told = []
    for threads in (1, 2, 4):
        with threadpool_limits(threads):
            told.append(shipped.outputs(planes, numbers))
    assert np.array_equal(told[0], told[1])
    assert np.array_equal(told[0], told[2])


@KINDS
def test_shapes_follow_from_the_layers(kind: type[CropNetwork]) -> None:
    rows, columns, _ = kind.ARCHITECTURE.crop
    planes = np.zeros((1, rows, columns, CHANNELS), np.float32)
    for layer, (side, stride, deep) in enumerate(kind.ARCHITECTURE.layers):
        kernel = np.zeros(kind.shapes()[f"kernel{layer}"], np.float32)
        planes = convolve(planes, kernel, np.zeros(deep, np.float32), side, stride, Workspace())
    assert planes.size + kind.ARCHITECTURE.features == kind.shapes()["all"][0]


@KINDS
def test_a_network_comes_back_from_its_file(kind: type[CropNetwork], tmp_path: Path) -> None:
    network = drawn_network(kind)
    network.save(tmp_path / "net.npz")
    read = kind.load(tmp_path / "net.npz")
    assert read.about == network.about
    for name, weights in network.weights.items():
        np.testing.assert_allclose(read.weights[name], weights, rtol=1e-3, atol=1e-6)


@pytest.mark.parametrize(
    ("kind", "model"), [(RescoringNetwork, "rescoring"), (BoxRefinementNetwork, "box-refinement")]
)
def test_a_missing_file_names_the_command(kind: type[CropNetwork], model: str, tmp_path: Path) -> None:
    with refused("none.npz", f"peopleboy train {model}"):
        kind.load(tmp_path / "none.npz")


@KINDS
@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("last", np.zeros((3, 5), np.float32)),
        ("last_bias", np.full(5, np.nan, np.float32)),
        ("kernel0", np.zeros((2, 2), np.float32)),
    ],
)
def test_another_network_is_refused(
    kind: type[CropNetwork], tmp_path: Path, name: str, wrong: np.ndarray
) -> None:
    kind({**drawn_network(kind).weights, name: wrong}).save(tmp_path / "other.npz")
    with refused("other.npz", f"{name} must be finite float16"):
        kind.load(tmp_path / "other.npz")


def test_a_network_for_other_crops_is_refused(tmp_path: Path) -> None:
    drawn_network(RescoringNetwork).save(tmp_path / "other.npz")
    with refused("other.npz", "must be finite float16"):
        BoxRefinementNetwork.load(tmp_path / "other.npz")
