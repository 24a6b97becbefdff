from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from peopleboy.scenarios.studies.second_look.teach_network import first_weights
from peopleboy.tracker.proposals.crops import COLUMNS, NUMBERS, PLANES, ROWS
from peopleboy.tracker.proposals.second_look import (
    LAYERS,
    TOLD,
    SecondLook,
    in_parts,
    look_again,
    patches,
    shapes,
    shipped_network,
)
from peopleboy.tracker.proposals.suppression import Proposals
from tests.helpers.calls.refused import refused


def drawn_network(last: float = 0.0) -> SecondLook:
    weights = first_weights(np.random.default_rng(0))
    weights["last"] *= np.float32(last)
    return SecondLook(weights, {"learned from": "nothing"})


def image() -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (120, 160)).astype(np.uint8)


PAGE = Path(__file__).parents[3] / "docs" / "how" / "proposals.md"
FIRST = Proposals(np.array([[40.0, 30.0, 12.0, 60.0], [100.0, 40.0, 10.0, 50.0]]), np.array([1.5, -1.0]))


def test_a_kernel_is_a_filter() -> None:
    rng = np.random.default_rng(0)
    plane, kernel = rng.normal(size=(9, 7)).astype(np.float32), rng.normal(size=(3, 3)).astype(np.float32)
    ours = patches(plane[None, :, :, None], 3, 1) @ kernel.ravel()
    theirs = cv2.filter2D(plane, -1, kernel, borderType=cv2.BORDER_CONSTANT)
    np.testing.assert_allclose(ours[0], theirs, atol=1e-5)
    np.testing.assert_allclose(patches(plane[None, :, :, None], 3, 2) @ kernel.ravel(), ours[:, ::2, ::2])


@pytest.mark.parametrize("count", [1, 4, 7])
def test_what_is_told_does_not_hang_on_how_many_threads_there_are(count: int) -> None:
    rng = np.random.default_rng(count)
    planes = rng.standard_normal((count, ROWS, COLUMNS, PLANES)).astype(np.float32)
    numbers = rng.standard_normal((count, NUMBERS)).astype(np.float32)
    told = []
    for threads in (1, 2, 4):
        with threadpool_limits(threads):
            told.append(shipped_network().told(planes, numbers))
    assert np.array_equal(told[0], told[1])
    assert np.array_equal(told[0], told[2])


def test_a_product_in_parts_is_the_product() -> None:
    rng = np.random.default_rng(0)
    one, other = rng.standard_normal((3, 1300)), rng.standard_normal((1300, 5))
    product = in_parts(one.astype(np.float32), other.astype(np.float32))
    np.testing.assert_allclose(product, one @ other, rtol=1e-4, atol=1e-4)


def test_shapes_follow_from_the_layers() -> None:
    planes = np.zeros((2, ROWS, COLUMNS, PLANES), np.float32)
    for layer, (side, stride, _) in enumerate(LAYERS):
        planes = patches(planes, side, stride) @ np.zeros(shapes()[f"kernel{layer}"], np.float32)
    assert planes[0].size + NUMBERS == shapes()["all"][0]


def test_who_knows_nothing_says_what_the_first_look_did() -> None:
    found = look_again(drawn_network(), image(), image(), FIRST, None, -2.0)
    np.testing.assert_allclose(found.score, FIRST.score)
    middle, foot = (
        np.array([[left + width / 2.0, top + height] for left, top, width, height in box])
        for box in (found.box, FIRST.box)
    )
    np.testing.assert_allclose(middle, foot)


def test_nobody_below_the_least_is_told() -> None:
    assert len(look_again(drawn_network(), image(), image(), FIRST, None, 0.0).score) == 1
    assert len(look_again(drawn_network(), image(), image(), FIRST, None, 9.0).score) == 0
    none = Proposals(np.empty((0, 4)), np.empty(0))
    assert len(look_again(drawn_network(), image(), image(), none, None, -9.0).score) == 0


def test_each_is_judged_by_itself() -> None:
    network = drawn_network(30.0)
    both = look_again(network, image(), image(), FIRST, None, -99.0)
    for k in range(2):
        one = Proposals(FIRST.box[k : k + 1], FIRST.score[k : k + 1])
        alone = look_again(network, image(), image(), one, None, -99.0)
        assert np.isclose(both.score, alone.score[0], atol=1e-3).any()


def test_a_network_comes_back_from_its_file(tmp_path: Path) -> None:
    network = drawn_network(1.0)
    network.save(tmp_path / "net.npz")
    read = SecondLook.load(tmp_path / "net.npz")
    assert read.about == network.about
    for name, weights in network.weights.items():
        np.testing.assert_allclose(read.weights[name], weights, rtol=1e-3, atol=1e-6)


def test_a_missing_file_names_the_command(tmp_path: Path) -> None:
    with refused("none.npz", "train-detector --second-look"):
        SecondLook.load(tmp_path / "none.npz")


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("last", np.zeros((3, TOLD), np.float32)),
        ("line", np.array([np.nan, 0.0], np.float32)),
        ("kernel0", np.zeros((2, 2), np.float32)),
    ],
)
def test_another_network_is_refused(tmp_path: Path, name: str, wrong: np.ndarray) -> None:
    network = drawn_network()
    replace(network, weights={**network.weights, name: wrong}).save(tmp_path / "other.npz")
    with refused("other.npz", "holds no network for crops of 64 x 48"):
        SecondLook.load(tmp_path / "other.npz")


def test_the_shipped_one_says_what_it_was_learned_from() -> None:
    assert "films" in shipped_network().about["learned from"]


def test_the_page_says_how_good_the_shipped_one_is() -> None:
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert shipped_network().about["on 200 others"] in page
