from pathlib import Path

import numpy as np

from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.detector.rescoring import RescoringNetwork, rescore, shipped_rescoring
from tests.helpers.images.drawn_crops import drawn_weights


def drawn_network(last: float = 0.0) -> RescoringNetwork:
    line = {"line": np.array([1.0, 0.0], np.float32)}
    return RescoringNetwork(drawn_weights(RescoringNetwork.ARCHITECTURE, last) | line)


def image() -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (120, 160)).astype(np.uint8)


PAGE = Path(__file__).parents[3] / "docs" / "explanation" / "detector.md"
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


def test_the_shipped_one_says_what_it_was_learned_from() -> None:
    assert "films" in shipped_rescoring().about["learned from"]


def test_the_page_says_how_good_the_shipped_one_is() -> None:
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert shipped_rescoring().about["on 200 others"] in page
