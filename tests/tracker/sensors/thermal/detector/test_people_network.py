from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.convolution import Workspace
from peopleboy.tracker.sensors.thermal.detector.people_network import (
    HEIGHTS,
    OUTPUTS,
    SHIFT,
    USUAL,
    NetworkDetections,
    PeopleNetwork,
    decode,
    input_planes,
    suppress,
)
from tests.helpers.calls.refused import refused

MOUNT = Mount(60.0, 300.0, 1.2)


def drawn_network(seed: int = 0) -> PeopleNetwork:
    rng = np.random.default_rng(seed)
    weights = {
        name: (rng.standard_normal(shape) / np.sqrt(shape[0])).astype(np.float32)
        for name, shape in PeopleNetwork.shapes().items()
    }
    return PeopleNetwork(weights | {"line": np.array([1.0, 0.0], np.float32)}, {"trained on": "nothing"})


def drawn_image(seed: int = 0, shape: tuple[int, int] = (120, 170)) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape).astype(np.uint8)


def test_a_map_gives_the_person_at_its_maximum() -> None:
    outputs = np.full((6, 8, OUTPUTS), -9.0, np.float32)
    box = np.array([0.5, -0.25, 0.0, np.log(0.25), np.log(0.2), np.log(0.3)])
    outputs[2, 3, 0] = 1.5
    outputs[2, 3, 1:7] = box - USUAL
    outputs[2, 4] = outputs[2, 3]
    outputs[2, 4, 0] = 1.2  # beside it, and lower
    outputs[2, 3, 7:] = np.arange(5)
    found = decode({8: outputs}, 0.0, (2.0, -1.0))
    unit = HEIGHTS * 8
    u, v = 3.5 * 8 - 0.5 + SHIFT * unit * 0.5, 2.5 * 8 - 0.5 - SHIFT * unit * 0.25
    assert found.score.tolist() == [2.0]
    np.testing.assert_allclose(found.box, [[u - unit / 8, v - unit / 2, unit / 4, unit]], rtol=1e-6)
    np.testing.assert_allclose(found.edges, [[-0.2, 0.3]], rtol=1e-6)
    assert found.posture.tolist() == [[0.0, 1.0, 2.0, 3.0, 4.0]]


def test_of_boxes_on_one_person_the_best_is_kept() -> None:
    box = np.array([[0.0, 0.0, 10.0, 40.0], [1.0, 0.0, 10.0, 40.0], [30.0, 0.0, 10.0, 40.0]])
    found = NetworkDetections(np.array([1.0, 2.0, 0.0]), box, box[:, :2], np.zeros((3, 5)))
    assert suppress(found).box.tolist() == [box[1].tolist(), box[2].tolist()]
    assert len(suppress(NetworkDetections(*(column[:0] for column in found))).score) == 0


def test_gain_and_offset_of_the_greys_cancel_out() -> None:
    grey = (drawn_image() // 4 + 60).astype(np.uint8)
    change = drawn_image(1) // 8
    one, same = input_planes(grey, change, MOUNT), input_planes(2 * grey - 80, 2 * change, MOUNT)
    np.testing.assert_allclose(one, same, atol=0.2)


def test_the_expected_height_is_that_of_a_person_standing_at_the_row() -> None:
    planes = input_planes(drawn_image(), drawn_image(1), MOUNT)[..., 3]
    assert (planes[:61] == 0.25).all()
    assert planes[100, 0] == pytest.approx(0.25 + 1.7 * 40.0 / 1.2 / 64.0)
    assert (input_planes(drawn_image(), drawn_image(1), None)[..., 3] == 0.0).all()


@pytest.mark.parametrize("shape", [(120, 170), (33, 40), (256, 320)])
def test_results_do_not_depend_on_threads_or_buffers(shape: tuple[int, int]) -> None:
    network, grey = drawn_network(), drawn_image(3, shape)
    found, used = [], Workspace()
    network.detect(drawn_image(4), drawn_image(5), MOUNT, 0.0, used)
    for threads, workspace in ((1, Workspace()), (2, used), (4, used)):
        with threadpool_limits(threads):
            found.append(network.detect(grey, drawn_image(2, shape), MOUNT, 0.0, workspace))
    for other in found[1:]:
        for a, b in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_a_network_comes_back_from_its_file(tmp_path: Path) -> None:
    network = drawn_network()
    network.save(tmp_path / "net.npz")
    read = PeopleNetwork.load(tmp_path / "net.npz")
    assert read.about == network.about
    for name, weights in network.weights.items():
        np.testing.assert_allclose(read.weights[name], weights, rtol=1e-3, atol=1e-6)


def test_a_missing_file_names_the_command(tmp_path: Path) -> None:
    with refused("cannot be read", "peopleboy train people"):
        PeopleNetwork.load(tmp_path / "none.npz")
