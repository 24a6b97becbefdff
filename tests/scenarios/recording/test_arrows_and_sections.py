from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.arrows import believed_arrows, true_arrows
from peopleboy.scenarios.recording.explanations import (
    OUT_OF_VIEW,
    explained_lines,
    explained_points,
    section_marks,
)
from peopleboy.tracker.thermal.contour.contour import SECTIONS
from peopleboy.tracker.thermal.contour.section_evidence import Evidence
from peopleboy.tracker.thermal.variants import VARIANTS
from peopleboy.tracker.track import Status
from tests.helpers.runs import synthetic_ticks as made

PEOPLEBOY = VARIANTS["peopleboy"]
BEHIND = replace(made.with_box((200.0, 60.0, 30.0, 120.0)), id=2, occluder=1, status=Status.PARTLY_OCCLUDED)


def evidence(response: float, seen: float = 1.0) -> dict[int, Evidence]:
    return {1: Evidence(np.full(SECTIONS, response), np.full(SECTIONS, seen))}


def test_true_arrows_leave_out_things_and_slivers() -> None:
    anna, ben = made.person(1, "anna", 4.0), made.person(2, "ben", 6.0, 0.4)
    assert true_arrows([anna, ben]).label == ["40%"]
    assert true_arrows([anna, replace(ben, hidden_by={"anna": 0.01, "pillar": 0.9})]).label == []


def test_the_tracker_s_arrow_goes_from_the_occluder_and_has_its_colour() -> None:
    arrows = believed_arrows([made.TRACK, BEHIND])
    assert arrows.start[0, 0] == pytest.approx(160.0)
    assert (arrows.start + arrows.vector)[0, 0] == pytest.approx(215.0)
    assert arrows.colour.tolist() == [list(track_colour(1))]


def test_there_is_no_arrow_from_an_occluder_who_is_no_longer_there() -> None:
    assert believed_arrows([BEHIND]).start.shape == (0, 2)


def test_sections_go_from_red_to_blue_with_the_evidence() -> None:
    threshold = PEOPLEBOY.likelihood.threshold
    shades = [
        section_marks([made.TRACK], evidence(factor * threshold), made.explain()).colour.astype(int)
        for factor in (-1.0, 0.5, 1.0, 1.5, 3.0)
    ]
    assert [len(shade) for shade in shades] == [SECTIONS + 1] * 5
    blue_over_red = [int(shade[0, 2] - shade[0, 0]) for shade in shades]
    assert blue_over_red == sorted(blue_over_red)
    assert blue_over_red[0] < -100
    assert blue_over_red[-1] > 100


def test_a_section_that_is_mostly_hidden_is_grey_whatever_was_measured() -> None:
    marks = section_marks([made.TRACK], evidence(np.nan, seen=0.2), made.explain())
    assert marks.colour.tolist() == [list(OUT_OF_VIEW)] * SECTIONS + [list(track_colour(1))]


def test_a_tracker_that_looks_at_no_feet_has_seven_sections() -> None:
    explanation = replace(made.explain(), config=VARIANTS["thesis"])
    assert len(section_marks([made.TRACK], evidence(0.5), explanation).line) == 7 + 1


def test_a_tracker_that_explains_nothing_has_neither_lines_nor_points() -> None:
    tick = replace(made.make_tick(10), explanation=None)
    assert explained_lines(tick.explanation, tick).line.shape == (0, 2, 2)
    assert explained_points(tick.explanation) == {}
