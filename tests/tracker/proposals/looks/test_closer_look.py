from pathlib import Path

import cv2
import numpy as np

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.proposals.looks.closer_look import CloserLook, look_closer, shipped_closer_look
from peopleboy.tracker.proposals.suppression import Proposals
from tests.helpers.images.drawn_looks import drawn_weights

PAGE = Path(__file__).parents[4] / "docs" / "how" / "proposals.md"
FOUND = Proposals.of_trees(
    np.array([[40.0, 30.0, 12.0, 60.0], [100.0, 40.0, 10.0, 50.0]]), np.array([1.5, -1.0])
)
MOUNT = Mount(60.0, 160.0, 1.2)


def image() -> np.ndarray:
    noise = np.random.default_rng(2).normal(90.0, 40.0, (120, 160))
    return np.clip(cv2.GaussianBlur(noise, (0, 0), 2.0), 0.0, 255.0).astype(np.uint8)


def test_scores_and_who_comes_first_stay() -> None:
    network = CloserLook(drawn_weights(CloserLook.FORM))
    placed = look_closer(network, image(), image(), FOUND, MOUNT)
    np.testing.assert_array_equal(placed.score, FOUND.score)
    assert (iou(placed.box, FOUND.box) > 0.5).all()
    assert not np.array_equal(placed.box, FOUND.box)


def test_who_knows_nothing_leaves_people_where_they_are() -> None:
    placed = look_closer(CloserLook(drawn_weights(CloserLook.FORM, 0.0)), image(), image(), FOUND, None)
    left, top, width, height = placed.box.T
    np.testing.assert_allclose(left + width / 2.0, FOUND.box[:, 0] + FOUND.box[:, 2] / 2.0)
    np.testing.assert_allclose([top, height], FOUND.box[:, [1, 3]].T)


def test_each_is_placed_by_itself() -> None:
    network = CloserLook(drawn_weights(CloserLook.FORM))
    both = look_closer(network, image(), image(), FOUND, MOUNT)
    for k in range(2):
        one = Proposals.of_trees(FOUND.box[k : k + 1], FOUND.score[k : k + 1])
        alone = look_closer(network, image(), image(), one, MOUNT)
        np.testing.assert_allclose(alone.box[0], both.box[k], atol=1e-3)


def test_nobody_found_is_nobody_placed() -> None:
    none = Proposals.of_trees(np.empty((0, 4)), np.empty(0))
    assert len(look_closer(shipped_closer_look(), image(), image(), none, None).box) == 0


def test_the_page_says_how_good_the_shipped_one_is() -> None:
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert "films" in shipped_closer_look().about["learned from"]
    assert shipped_closer_look().about["on 200 others"] in page
