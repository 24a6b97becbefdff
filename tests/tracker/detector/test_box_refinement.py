from pathlib import Path

import cv2
import numpy as np

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.detector.box_refinement import (
    BoxRefinementNetwork,
    refine_boxes,
    shipped_box_refinement,
)
from peopleboy.tracker.detector.detections import Detections
from tests.helpers.images.drawn_crops import drawn_weights

PAGE = Path(__file__).parents[3] / "docs" / "explanation" / "detector.md"
FOUND = Detections.from_trees(
    np.array([[40.0, 30.0, 12.0, 60.0], [100.0, 40.0, 10.0, 50.0]]), np.array([1.5, -1.0])
)
MOUNT = Mount(60.0, 160.0, 1.2)


def image() -> np.ndarray:
    noise = np.random.default_rng(2).normal(90.0, 40.0, (120, 160))
    return np.clip(cv2.GaussianBlur(noise, (0, 0), 2.0), 0.0, 255.0).astype(np.uint8)


def test_scores_and_who_comes_first_stay() -> None:
    network = BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE))
    placed = refine_boxes(network, image(), image(), FOUND, MOUNT)
    np.testing.assert_array_equal(placed.score, FOUND.score)
    assert (iou(placed.box, FOUND.box) > 0.5).all()
    assert not np.array_equal(placed.box, FOUND.box)


def test_who_knows_nothing_leaves_people_where_they_are() -> None:
    placed = refine_boxes(
        BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE, 0.0)),
        image(),
        image(),
        FOUND,
        None,
    )
    left, top, width, height = placed.box.T
    np.testing.assert_allclose(left + width / 2.0, FOUND.box[:, 0] + FOUND.box[:, 2] / 2.0)
    np.testing.assert_allclose([top, height], FOUND.box[:, [1, 3]].T)


def test_each_is_placed_by_itself() -> None:
    network = BoxRefinementNetwork(drawn_weights(BoxRefinementNetwork.ARCHITECTURE))
    both = refine_boxes(network, image(), image(), FOUND, MOUNT)
    for k in range(2):
        one = Detections.from_trees(FOUND.box[k : k + 1], FOUND.score[k : k + 1])
        alone = refine_boxes(network, image(), image(), one, MOUNT)
        np.testing.assert_allclose(alone.box[0], both.box[k], atol=1e-3)


def test_nobody_found_is_nobody_placed() -> None:
    none = Detections.from_trees(np.empty((0, 4)), np.empty(0))
    assert len(refine_boxes(shipped_box_refinement(), image(), image(), none, None).box) == 0


def test_the_page_says_how_good_the_shipped_one_is() -> None:
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert "films" in shipped_box_refinement().about["learned from"]
    assert shipped_box_refinement().about["on 200 others"] in page
