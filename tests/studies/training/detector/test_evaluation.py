import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from peopleboy.studies.training.detector import evaluation
from peopleboy.studies.training.detector.evaluation import DetectionScores, calibrate
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.people_trees import shipped_people_trees
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind
from tests.helpers.calls.refused import refused

Floats = NDArray[np.float64]
SCORES: Floats = np.random.default_rng(0).uniform(-2.0, 4.0, 4000)

WHOLE = WindowKind.WHOLE, shipped_people_trees().trees[WindowKind.WHOLE]


def test_figures_of_what_was_found() -> None:
    found = DetectionScores(
        score=np.array([3.0, 2.0, 1.0, 0.0]),
        is_person=np.array([True, False, True, False]),
        overlap=np.array([0.8, 0.0, 0.6, 0.0]),
        people=4,
        images=10,
    )
    assert found.recall(0.0) == 0.25
    assert found.recall(0.1) == 0.5
    assert found.precision() == pytest.approx((1.0 + 2.0 / 3.0) / 4.0)
    assert "mean IoU 0.700" in str(found)


def propose(monkeypatch: pytest.MonkeyPatch, shot: ThermalImage, is_person: NDArray[np.bool_]) -> None:
    """Let the detector propose the person of a shot with some scores, and what is none with the others."""
    box = np.where(is_person[:, None], shot.box, shot.box + np.array([500.0, 0.0, 0.0, 0.0]))
    monkeypatch.setattr(evaluation, "detect_with_trees", lambda *_: Detections.from_trees(box, SCORES))


def test_scores_become_the_log_odds_that_it_is_somebody(
    shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch
) -> None:
    odds = np.exp(1.5 * SCORES - 2.0)
    propose(monkeypatch, shots[0], np.random.default_rng(1).random(len(SCORES)) < odds / (1.0 + odds))
    gain, offset = calibrate(*WHOLE, shots[:1])
    assert gain == pytest.approx(1.5, abs=0.15)
    assert offset == pytest.approx(-2.0, abs=0.2)


@pytest.mark.parametrize("is_person", [SCORES > -9.0, SCORES > 9.0])
def test_people_alone_or_none_at_all_tell_no_odds(
    is_person: NDArray[np.bool_], shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch
) -> None:
    propose(monkeypatch, shots[0], is_person)
    with refused(f"{2 * is_person.sum()} of {2 * len(SCORES)} validation detections", "use more sequences"):
        calibrate(*WHOLE, shots[:1])


def test_scores_that_say_the_contrary_are_refused(
    shots: list[ThermalImage], monkeypatch: pytest.MonkeyPatch
) -> None:
    propose(monkeypatch, shots[0], SCORES + np.random.default_rng(1).normal(size=len(SCORES)) < 1.0)
    with refused("people do not score higher than negatives", "use more sequences"):
        calibrate(*WHOLE, shots[:1])


def test_without_what_teaches_it_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.linear_model", None)
    with refused("scikit-learn", "pip install scikit-learn"):
        calibrate(*WHOLE, [])
