"""Tests of who overlaps whom."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.tracking.association import are_overlapped, find_occluders, shared_area

FRONT, BEHIND, APART = (100.0, 60.0, 30.0, 120.0), (110.0, 60.0, 20.0, 90.0), (250.0, 60.0, 25.0, 100.0)
BOXES = np.array([FRONT, BEHIND, APART])
ALL = np.ones(3, np.bool_)


def test_who_is_not_found_is_hidden_by_who_is() -> None:
    assert find_occluders(BOXES, ALL, [0, 2]) == [None, 0, None]
    assert find_occluders(BOXES, ALL, [1, 2]) == [None, None, None]


def test_two_who_overlap_are_not_seen_apart() -> None:
    assert are_overlapped(BOXES, ALL).tolist() == [True, True, False]


def test_what_is_shared_is_told_of_the_smaller_box_and_never_of_ones_own() -> None:
    assert shared_area(BOXES, [0]) == pytest.approx([0.0, 1.0, 0.0])
    assert shared_area(BOXES, [0, 1]) == pytest.approx([1.0, 1.0, 0.0])
    assert shared_area(BOXES, []) == pytest.approx([0.0, 0.0, 0.0])
