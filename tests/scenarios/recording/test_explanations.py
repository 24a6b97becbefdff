"""What the handover believes is drawn on the thermal image for those whom its thermal tracker sees."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.explanations import explained_lines, explained_points
from peopleboy.tracker.handover.both_explanations import BothExplanations
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
