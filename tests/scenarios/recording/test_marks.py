from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.scenarios.drawing.palette import track_colour
from peopleboy.scenarios.recording.explanations import (
    OUT_OF_VIEW,
    draw_explained_lines,
    draw_explained_points,
    section_marks,
)
from peopleboy.scenarios.recording.marks import (
    PARTICLES_A_FILTER,
    PARTICLES_AT_MOST,
    Sightings,
    Trails,
    believed_arrows,
    box_offset,
    particle_points,
    places,
    track_boxes,
    true_arrows,
    truth_boxes,
)
from peopleboy.tracker.reproductions.contour.measurement.contour import SECTIONS
from peopleboy.tracker.reproductions.contour.measurement.section_evidence import Evidence
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.track import FloorPlace, Status
from tests.helpers.runs import synthetic_ticks as made


def test_boxes_of_tracks_say_the_id_and_what_is_unusual() -> None:
    hidden = replace(made.with_status(Status.TOTALLY_OCCLUDED), occluder=2)
    boxes = track_boxes([made.TRACK, made.with_status(Status.TENTATIVE), hidden])
    assert boxes.label == ["1", "1 doubtful", "1 hidden behind 2"]
    assert boxes.box == pytest.approx(np.array([made.TRACK.boxes["thermal"]] * 3), rel=1e-6)
    assert boxes.colour.tolist() == [list(track_colour(1))] * 3


def test_true_boxes_leave_out_who_is_behind_the_camera() -> None:
    anna, ben = made.make_tick(1).truth.people
    boxes = truth_boxes([anna, replace(ben, box=None)])
    assert boxes.box == pytest.approx(np.array([anna.box]), rel=1e-6)
    assert boxes.label == ["anna 100%"]


def test_the_offset_is_one_at_the_right_edge_of_the_image() -> None:
    _, top, width, height = made.TRACK.boxes["thermal"]
    at_edge = made.with_box((319.5 - width / 2.0, top, width, height))
    assert box_offset(at_edge.boxes["thermal"], 320) == pytest.approx(1.0)


def test_many_filters_share_the_particles_that_are_shown() -> None:
    cloud = made.make_tick(10).explanation.particles[1]
    assert len(particle_points(dict.fromkeys(range(1, 6), cloud)).place) == PARTICLES_AT_MOST


def test_the_strongest_particles_are_shown_brightest() -> None:
    cloud = made.make_tick(10).explanation.particles[1]
    weight = np.linspace(0.0, 2.0 / len(cloud), len(cloud), dtype=np.float32)
    points = particle_points({1: type(cloud)(cloud.state, weight)})
    assert len(points.place) == PARTICLES_A_FILTER
    brightness = points.colour.sum(axis=1)
    assert np.array_equal(points.place[0], cloud.state[-1, :2])
    assert brightness[0] == brightness.max() > 2 * brightness.min()


def test_few_particles_are_all_shown_and_none_are_none() -> None:
    cloud = made.make_tick(10).explanation.particles[1]
    few = type(cloud)(cloud.state[:7], np.full(7, 1 / 7, np.float32))
    assert len(np.unique(particle_points({1: few}).place, axis=0)) == 7
    assert particle_points({}).place.shape == (0, 2)


def test_a_trail_joins_places_and_breaks_where_somebody_was_away() -> None:
    trails = Trails()
    counts = [len(trails.update(made.make_tick(frame)).line) for frame in (1, 2, 60, 3, 4)]
    # Robot, anna and ben; ben is away at frame 60.
    assert counts == [0, 3, 2, 2, 3]


def test_places_tell_in_whose_newest_images_a_person_is() -> None:
    sightings = Sightings(("thermal", "colour", "rear"))
    place = FloorPlace(position_m=(3.0, 0.0), covariance_m2=(0.1, 0.0, 0.1))
    labels = []
    for cameras, images in (
        (("thermal",), ("thermal", "rear")),
        (("thermal", "rear"), ("thermal", "rear")),
        ((), ("thermal",)),
        (("thermal",), ("thermal", "rear")),
        ((), ("thermal", "rear")),
    ):
        box = made.TRACK.boxes["thermal"]
        track = replace(made.TRACK, boxes=dict.fromkeys(cameras, box), place=place)
        tick = made.make_tick(1)
        seen = replace(tick.observation, images=dict.fromkeys(images, tick.observation.images["thermal"]))
        found = sightings.update(replace(tick, observation=seen, tracks=(track,)))
        labels += places([track], found).label
    # The rear camera's last image still counts while it takes no other.
    assert labels == ["1 · thermal", "1 · thermal+rear", "1 · rear", "1 · thermal", "1"]


CONTOUR = VARIANTS["contour"]
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
    threshold = CONTOUR.likelihood.threshold
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
    assert draw_explained_lines(tick.explanation, tick).line.shape == (0, 2, 2)
    assert draw_explained_points(tick.explanation) == {}
