import numpy as np
import pytest

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.learned_network import mean_overlaps
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from peopleboy.tracker.proposals.placing import moved


def test_overlap_of_offsets_is_that_of_the_boxes() -> None:
    rng = np.random.default_rng(0)
    told, true = (rng.normal(0.0, 0.03, (20, 4)) + np.array([0.0, 0.0, 0.0, 0.22]) for _ in range(2))
    before = rng.random(20).astype(np.float32)
    none = LookExamples.joined([], CloserLook.FORM.crop)
    looks = none._replace(offsets=true.astype(np.float32), overlap=before)
    window = np.tile([40.0, 50.0, 30.0, 80.0], (20, 1))
    expected = iou(moved(window, told), moved(window, true))
    rows = np.arange(20) > 6
    assert mean_overlaps(told, looks, rows) == pytest.approx(
        (before[rows].mean(), expected[rows].mean()), rel=1e-5
    )
