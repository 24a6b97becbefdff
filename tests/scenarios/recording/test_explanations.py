"""What trackers believe is drawn on the thermal image by its kind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.explanations import LIKELY, UNLIKELY, explained_lines, explained_points
from peopleboy.tracker.fusion.explanations import BothExplanations
from peopleboy.tracker.tracking.association import DetectionExplanation
from tests.helpers.runs import synthetic_ticks as made
from tests.helpers.runs.hand_made_tracks import track


def test_only_who_has_a_contour_is_drawn_and_in_the_colour_of_the_shared_number() -> None:
    alone = made.make_tick(10)
    both = BothExplanations.of(alone.explanation, None, {1: 4})
    tick = replace(alone, tracks=(track(2), replace(made.TRACK, id=4), track(9)), explanation=both)
    told, usual = explained_lines(both, tick), explained_lines(alone.explanation, alone)
    assert np.array_equal(told.line, usual.line)
    assert tuple(told.colour[-1]) == track_colour(4)
    assert np.array_equal(told.colour[:-1], usual.colour[:-1])


def test_samples_are_those_of_the_thermal_tracker() -> None:
    contours = made.make_tick(10).explanation
    told = explained_points(BothExplanations.of(contours, None, {1: 4}))
    usual = explained_points(contours)
    assert told.keys() == usual.keys()
    detector = "particles/detector"
    assert np.array_equal(told[detector].place, usual[detector].place)
    assert len(told["particles/people"].place) == len(usual["particles/people"].place) > 0


def test_with_nobody_in_the_thermal_image_nothing_is_drawn_there() -> None:
    both = BothExplanations.of(made.make_tick(10, None).explanation, None, {})
    assert len(explained_lines(both, replace(made.make_tick(10), tracks=(track(2),))).line) == 0


def test_of_other_explanations_nothing_is_drawn() -> None:
    assert len(explained_lines(None, made.make_tick(10)).line) == 0
    assert explained_points(object()) == {}


def test_what_is_proposed_has_its_corners_drawn_blue_if_it_is_rather_somebody_than_not() -> None:
    boxes = np.array([(20.0, 30.0, 10.0, 40.0), (100.0, 50.0, 20.0, 60.0)])
    proposed = DetectionExplanation(boxes=boxes, scores=np.array([1.5, -0.5]))
    told = explained_lines(proposed, replace(made.make_tick(10), explanation=proposed))
    assert told.line.shape == (8, 3, 2)
    assert told.colour.tolist() == [list(LIKELY)] * 4 + [list(UNLIKELY)] * 4
    for corners, (left, top, width, height) in zip(np.split(told.line, 2), boxes.tolist(), strict=True):
        points = corners.reshape(-1, 2)
        assert points.min(axis=0).tolist() == [left, top]
        assert points.max(axis=0).tolist() == [left + width, top + height]
        assert corners[:, 1].tolist() == [
            [left, top], [left + width, top], [left, top + height], [left + width, top + height],
        ]  # fmt: skip
        assert np.ptp(corners, axis=1).tolist() == [[0.3 * width] * 2] * 4
