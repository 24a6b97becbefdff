import re

import cv2
import numpy as np
import pytest

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.rescoring import (
    BoxRefinementNetwork,
    RescoringNetwork,
    encode_edges,
    refine_boxes,
    rescore,
)
from tests.helpers.images.drawn_crops import drawn_weights
from tests.helpers.import_graph import ROOT


def drawn_network(last: float = 0.0) -> RescoringNetwork:
    line = {"line": np.array([1.0, 0.0], np.float32)}
    return RescoringNetwork(drawn_weights(RescoringNetwork.ARCHITECTURE, last) | line)


def image() -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (120, 160)).astype(np.uint8)


def smooth_image() -> np.ndarray:
    noise = np.random.default_rng(2).normal(90.0, 40.0, (120, 160))
    return np.clip(cv2.GaussianBlur(noise, (0, 0), 2.0), 0.0, 255.0).astype(np.uint8)


MOUNT = Mount(60.0, 160.0, 1.2)
PAGE = ROOT / "docs" / "reference" / "models.md"
FIRST = Detections.from_trees(
    np.array([[40.0, 30.0, 12.0, 60.0], [100.0, 40.0, 10.0, 50.0]]), np.array([1.5, -1.0])
)


def test_who_knows_nothing_says_what_the_first_look_did() -> None:
    found = rescore(drawn_network(), image(), image(), FIRST, None, -2.0)
    np.testing.assert_allclose(found.score, FIRST.score)
    middle, foot = (
        np.array([[left + width / 2.0, top + height] for left, top, width, height in box])
        for box in (found.box, FIRST.box)
    )
    np.testing.assert_allclose(middle, foot)


def test_nobody_below_the_least_is_told() -> None:
    assert len(rescore(drawn_network(), image(), image(), FIRST, None, 0.0).score) == 1
    assert len(rescore(drawn_network(), image(), image(), FIRST, None, 9.0).score) == 0
    none = Detections.from_trees(np.empty((0, 4)), np.empty(0))
    assert len(rescore(drawn_network(), image(), image(), none, None, -9.0).score) == 0


def test_each_is_judged_by_itself() -> None:
    network = drawn_network(5.0)
    both = rescore(network, image(), image(), FIRST, None, -99.0)
    for k in range(2):
        one = Detections.from_trees(FIRST.box[k : k + 1], FIRST.score[k : k + 1])
        alone = rescore(network, image(), image(), one, None, -99.0)
        assert np.isclose(both.score, alone.score[0], atol=1e-3).any()


def test_scores_and_who_comes_first_stay() -> None:
    network = BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE))
    placed = refine_boxes(network, smooth_image(), smooth_image(), FIRST, MOUNT)
    np.testing.assert_array_equal(placed.score, FIRST.score)
    assert (iou(placed.box, FIRST.box) > 0.5).all()
    assert not np.array_equal(placed.box, FIRST.box)


def test_who_knows_nothing_leaves_people_where_they_are() -> None:
    placed = refine_boxes(
        BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE, 0.0)),
        smooth_image(),
        smooth_image(),
        FIRST,
        None,
    )
    left, top, width, height = placed.box.T
    np.testing.assert_allclose(left + width / 2.0, FIRST.box[:, 0] + FIRST.box[:, 2] / 2.0)
    np.testing.assert_allclose([top, height], FIRST.box[:, [1, 3]].T)


def test_edges_are_those_of_the_image_whatever_becomes_of_the_box() -> None:
    weights = drawn_weights(BoxRefinementNetwork.ARCHITECTURE, 0.0)
    weights["last_bias"] = np.array([2.0, 1.0, -3.0, 0.5, 1.0, 2.0], np.float32)
    network = BoxRefinementNetwork(weights)
    refined = refine_boxes(network, image(), image(), FIRST, MOUNT)

    def edges(found: Detections, relative: np.ndarray) -> np.ndarray:
        middle = found.box[:, [0]] + found.box[:, [2]] / 2.0
        return np.asarray(middle + relative * found.box[:, [3]])

    predicted = np.array([-0.18 + 0.04, 0.18 + 0.08])
    np.testing.assert_allclose(edges(refined, refined.edges), edges(FIRST, predicted), rtol=1e-6)
    whole = np.column_stack([FIRST.box[:, 0] - 5.0, FIRST.box[:, 1], [30.0, 20.0], FIRST.box[:, 3]])
    np.testing.assert_allclose(
        edges(FIRST, encode_edges(FIRST.box, whole)), whole[:, [0]] + whole[:, [2]] * [0.0, 1.0]
    )


def test_each_is_placed_by_itself() -> None:
    network = BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE))
    both = refine_boxes(network, smooth_image(), smooth_image(), FIRST, MOUNT)
    for k in range(2):
        one = Detections.from_trees(FIRST.box[k : k + 1], FIRST.score[k : k + 1])
        alone = refine_boxes(network, smooth_image(), smooth_image(), one, MOUNT)
        np.testing.assert_allclose(alone.box[0], both.box[k], atol=1e-3)


def test_nobody_found_is_nobody_placed() -> None:
    none = Detections.from_trees(np.empty((0, 4)), np.empty(0))
    assert (
        len(refine_boxes(BoxRefinementNetwork.shipped(), smooth_image(), smooth_image(), none, None).box) == 0
    )


@pytest.mark.parametrize("network", [RescoringNetwork, BoxRefinementNetwork])
def test_the_page_says_how_good_the_shipped_ones_are(network: type[CropNetwork]) -> None:
    about = network.shipped().about
    assert "sequences" in about["trained on"]
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    (result,) = (text for key, text in about.items() if key.endswith("other sequences"))
    numbers = re.findall(r"\d+(?:\.\d+)?", result)
    assert re.search(".{1,80}".join(map(re.escape, numbers)), page)
