"""What trackers believe is drawn on the thermal image by its kind."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.explanations import (
    LIKELY,
    NOBODYS,
    UNLIKELY,
    column_bars,
    draw_explained_lines,
    draw_explained_points,
    draw_explained_sketches,
    floor_ellipse,
    outlines_of,
    row_bars,
)
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.tracker.frame import COLOUR
from peopleboy.tracker.reproductions.attention.attentive_explanation import (
    Attended,
    AttentiveExplanation,
)
from peopleboy.tracker.reproductions.attention.person_views import PersonView
from peopleboy.tracker.reproductions.panoramic.depth_cues import measure
from peopleboy.tracker.sensors.panorama.panorama_sensor import PanoramaExplanation
from peopleboy.tracker.sensors.thermal.thermal_sensor import DetectionExplanation
from peopleboy.tracker.track import FloorPlace
from peopleboy.tracker.tracking.sensor import SensorExplanations
from tests.helpers.runs import synthetic_ticks as made
from tests.helpers.runs.hand_made_tracks import track
from tests.helpers.runs.synthetic_ticks import explain


def test_only_who_has_a_contour_is_drawn_and_in_the_colour_of_the_shared_number() -> None:
    alone = made.make_tick(10)
    both = SensorExplanations((alone.explanation.renumbered({1: 4}), None))
    tick = replace(alone, tracks=(track(2), replace(made.TRACK, id=4), track(9)), explanation=both)
    told, usual = draw_explained_lines(both, tick), draw_explained_lines(alone.explanation, alone)
    assert np.array_equal(told.line, usual.line)
    assert tuple(told.colour[-1]) == track_colour(4)
    assert np.array_equal(told.colour[:-1], usual.colour[:-1])


def test_samples_are_those_of_the_thermal_tracker() -> None:
    contours = made.make_tick(10).explanation
    told = draw_explained_points(SensorExplanations((contours.renumbered({1: 4}), None)))
    usual = draw_explained_points(contours)
    assert told.keys() == usual.keys()
    detector = "particles/detector"
    assert np.array_equal(told[detector].place, usual[detector].place)
    assert len(told["particles/people"].place) == len(usual["particles/people"].place) > 0


def test_with_nobody_in_the_thermal_image_nothing_is_drawn_there() -> None:
    both = SensorExplanations((made.make_tick(10, None).explanation, None))
    assert len(draw_explained_lines(both, replace(made.make_tick(10), tracks=(track(2),))).line) == 0


def test_of_other_explanations_nothing_is_drawn() -> None:
    assert len(draw_explained_lines(None, made.make_tick(10)).line) == 0
    assert draw_explained_points(object()) == {}


def test_what_is_proposed_has_its_corners_drawn_blue_if_it_is_rather_somebody_than_not() -> None:
    boxes = np.array([(20.0, 30.0, 10.0, 40.0), (100.0, 50.0, 20.0, 60.0)])
    proposed = DetectionExplanation(boxes=boxes, scores=np.array([1.5, -0.5]), edges=np.full((2, 2), np.nan))
    told = draw_explained_lines(proposed, replace(made.make_tick(10), explanation=proposed))
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


def across() -> np.ndarray:
    mask = np.zeros((120, 480), np.bool_)
    mask[20:60, 474:] = True
    mask[30:70, :9] = True
    return mask


def test_outlines_pass_through_the_outermost_pixels_of_each_patch() -> None:
    mask = across()
    mask[100, 200] = True
    corners = [(*line.min(axis=0), *line.max(axis=0)) for line in outlines_of(mask)]
    spans = sorted(tuple(map(round, corner)) for corner in corners)
    assert spans == [(0, 30, 8, 69), (200, 100, 200, 100), (474, 20, 479, 59)]
    assert all((line[0] == line[-1]).all() for line in outlines_of(mask))


def test_histograms_stand_where_the_person_is() -> None:
    figure = measure(across())
    assert figure is not None
    right, left = column_bars(figure)
    assert (right[:, 0].min(), right[:, 0].max()) == (473.5, 479.5)
    assert (left[:, 0].min(), left[:, 0].max()) == (-0.5, 8.5)
    assert {round(119.5 - y, 6) for y in right[:, 1]} == {0.0, 12.0}
    rows = row_bars(figure)
    assert (rows[:, 1].min(), rows[:, 1].max()) == (19.5, 69.5)
    # There is no room to the right of the person.
    assert rows[:, 0].max() == 473.5
    assert rows[:, 0].min() == 473.5 - 15.0


@given(st.floats(1.5, 8.0), st.floats(-math.pi, math.pi), st.floats(0.01, 0.2))
def test_a_round_place_is_seen_at_its_bearing_and_as_wide_as_it_is(
    distance: float, bearing: float, deviation: float
) -> None:
    camera = Panorama()
    at, variance = (distance * math.cos(bearing), distance * math.sin(bearing)), deviation**2
    parts = floor_ellipse(FloorPlace(position_m=at, covariance_m2=(variance, 0.0, variance)), camera)
    columns = np.concatenate([part[:, 0] for part in parts])
    away = np.angle(np.exp(1j * (camera.bearing(columns) - bearing)))
    half = math.asin(2.4477 * deviation / distance)
    assert away.max() == pytest.approx(half, rel=0.01)
    assert away.min() == pytest.approx(-half, rel=0.01)
    assert all(np.abs(np.diff(part[:, 0])).max() < 240.0 for part in parts)


def people() -> PanoramaExplanation:
    background = np.random.default_rng(0).integers(0, 255, (120, 480, 3), np.uint8)
    shown = np.where(across(), np.float32(0.8), np.float32(0.3))
    return PanoramaExplanation(background, shown, np.zeros((120, 480), np.float32))


def test_people_all_round_are_drawn_as_outlines_and_where_each_stands() -> None:
    cameras, tracks = (
        {"panorama": PanoramaConfig()},
        (track(3, (3.0, 1.0)), track(5, (-3.0, 0.0)), track(6, None)),
    )
    (sketch,) = draw_explained_sketches(people(), tracks, cameras).values()
    assert np.array_equal(sketch.background, people().background)
    outlines = outlines_of(across())
    assert all((one == other).all() for one, other in zip(sketch.lines, outlines, strict=False))
    colours = [tuple(colour) for colour in sketch.colour.tolist()]
    assert len(colours) == len(sketch.lines)
    # Who stands behind the robot is drawn in parts on both sides of the seam.
    assert colours == [NOBODYS] * len(outlines) + [track_colour(3)] + [track_colour(5)] * 2


def test_of_the_handover_the_panoramas_part_is_drawn() -> None:
    cameras, tracks = {"panorama": PanoramaConfig()}, (track(3),)
    both = draw_explained_sketches(SensorExplanations((explain(), people())), tracks, cameras)
    alone = draw_explained_sketches(people(), tracks, cameras)
    assert both.keys() == alone.keys() == {"panorama"}
    assert np.array_equal(both["panorama"].colour, alone["panorama"].colour)
    assert draw_explained_sketches(SensorExplanations((explain(), None)), tracks, cameras) == {}


def test_of_other_explanations_no_sketch_is_drawn() -> None:
    assert draw_explained_sketches(object(), (), {}) == {}


def test_of_attention_the_focus_and_the_score_of_every_place_are_drawn() -> None:
    image = np.full((240, 320, 3), (120, 125, 130), np.uint8)
    image[60:210, 100:160] = (200, 40, 40)
    attended = Attended.learned(2, PersonView(COLOUR, image, (100.0, 60.0, 60.0, 150.0)))
    sketch = draw_explained_sketches(AttentiveExplanation(None, {}, attended), [], {})[COLOUR]
    assert sketch.background is not None
    assert sketch.background.shape == (240, 320)
    assert np.unravel_index(sketch.background.argmax(), (240, 320))[1] == pytest.approx(130, abs=12)
    assert len(sketch.lines) == len(sketch.colour) >= 3
    assert tuple(sketch.colour[0]) == track_colour(2)
