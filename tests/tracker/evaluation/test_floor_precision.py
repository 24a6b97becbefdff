"""Average precision on the floor against values worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.evaluation.floor import FloorFrame, average_precision


def frame(found: list[tuple[float, float, float]], *people: tuple[float, float, bool]) -> FloorFrame:
    rows, true = np.array(found).reshape(-1, 3), np.array(people, np.float64).reshape(-1, 3)
    return FloorFrame(rows[:, :2], rows[:, 2], true[:, :2], true[:, 2] > 0.0)


def test_precision_is_the_area_below_the_interpolated_curve() -> None:
    # By score: right, wrong, right; of two people.
    one = frame([(1.0, 0.0, 3.0), (5.0, 5.0, 2.0)], (1.1, 0.0, True))
    two = frame([(2.0, 0.3, 1.0)], (2.0, 0.0, True))
    score = average_precision([one, two], 0.5)
    assert score.average_precision == pytest.approx(0.5 * 1.0 + 0.5 * 2.0 / 3.0)
    assert score.error_m == pytest.approx(0.2)
    assert score.people == 2


def test_a_person_is_found_once_and_ignored_people_count_for_nothing() -> None:
    twice = average_precision([frame([(1.0, 0.0, 3.0), (1.1, 0.0, 2.0)], (1.0, 0.0, True))], 0.5)
    assert twice.precision.tolist() == [1.0, 0.5]
    ignored = average_precision([frame([(1.0, 0.0, 3.0)], (1.0, 0.0, False), (4.0, 0.0, True))], 0.5)
    assert (ignored.average_precision, len(ignored.precision)) == (0.0, 0)


def test_without_people_there_is_no_precision() -> None:
    assert np.isnan(average_precision([frame([(1.0, 0.0, 3.0)])], 0.5).average_precision)
