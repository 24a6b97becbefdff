from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.evaluation.average_precision import average_precision
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

TALL, SMALL = (10.0, 10.0, 20.0, 100.0), (100.0, 50.0, 10.0, 40.0)


def people(*rows: tuple[int, tuple[float, ...], bool]) -> TrueBoxes:
    return TrueBoxes.from_rows(
        (frame, number, box, counts, 1.0) for number, (frame, box, counts) in enumerate(rows)
    )


def detections(*rows: tuple[int, tuple[float, ...], float]) -> TrackBoxes:
    return TrackBoxes.from_rows((frame, k, box, score) for k, (frame, box, score) in enumerate(rows))


def moved(box: tuple[float, ...], share: float) -> tuple[float, ...]:
    """A box moved down so that the intersection is this share of the union."""
    return (box[0], box[1] + box[3] * (1.0 - share) / (1.0 + share), *box[2:])


def test_exact_boxes_have_full_precision_at_all_overlaps() -> None:
    truth = people((1, TALL, True), (2, SMALL, True))
    found = average_precision(truth, detections((1, TALL, 0.9), (2, SMALL, 0.8)))
    assert (found.ap, found.ap50) == (100.0, 100.0)


def test_ap_is_the_mean_over_the_thresholds_that_an_overlap_reaches() -> None:
    found = average_precision(people((1, TALL, True)), detections((1, moved(TALL, 0.77), 0.9)))
    assert found.ap50 == 100.0
    assert found.ap == pytest.approx(100.0 * 6 / 10)  # 0.5 to 0.75


def test_a_more_confident_false_positive_halves_the_precision_at_every_recall() -> None:
    wrong = (200.0, 10.0, 20.0, 100.0)
    truth = people((1, TALL, True))
    assert average_precision(truth, detections((1, wrong, 0.9), (1, TALL, 0.5))).ap50 == pytest.approx(50.0)
    assert average_precision(truth, detections((1, wrong, 0.4), (1, TALL, 0.5))).ap50 == 100.0


def test_half_of_the_people_found_is_precision_at_half_of_the_recalls() -> None:
    truth = people((1, TALL, True), (2, SMALL, True))
    assert average_precision(truth, detections((1, TALL, 0.9))).ap50 == pytest.approx(100.0 * 51 / 101)


def test_the_second_detection_of_a_person_is_wrong_unless_the_person_is_ignored() -> None:
    twice = detections((1, TALL, 0.9), (1, moved(TALL, 0.8), 0.95), (2, SMALL, 0.1))
    truth = people((1, TALL, True), (2, SMALL, True))
    assert average_precision(truth, twice).ap50 == pytest.approx(100.0 * (51 + 50 * 2 / 3) / 101)
    ignored = people((1, TALL, False), (2, SMALL, True))
    assert average_precision(ignored, twice).ap50 == 100.0


def test_people_of_other_heights_are_ignored_with_their_detections() -> None:
    truth = people((1, TALL, True), (1, SMALL, True))
    wrong = (200.0, 10.0, 20.0, 100.0)
    found = detections((1, wrong, 0.9), (1, SMALL, 0.5), (1, TALL, 0.4))
    assert average_precision(truth, found, (0.0, 48.0)).ap50 == 100.0
    assert average_precision(truth, found, (96.0, np.inf)).ap50 == pytest.approx(50.0)
    assert np.isnan(average_precision(truth, found, (48.0, 96.0)).ap50)
