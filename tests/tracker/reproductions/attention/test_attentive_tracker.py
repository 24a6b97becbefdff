"""People who keep their numbers, and strangers who get none of theirs."""

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import COLOUR, PANORAMA, THERMAL, Frame
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED
from peopleboy.tracker.reproductions.attention.attentive_tracker import (
    AS_FOUND,
    AttentiveConfig,
    AttentiveTracker,
)
from peopleboy.tracker.reproductions.attention.person_views import PersonView, box_in
from peopleboy.tracker.reproductions.attention.recogniser import ByColour, ByFocus
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import TRACKERS, make_tracker
from tests.helpers.calls.refused import refused
from tests.tracker.reproductions.attention.test_attend import GREEN, RED, scene

BLUE = (40, 60, 170)
HZ = 15.0


class Script:
    """A tracker that tells what it is told to."""

    cameras = (THERMAL,)

    def __init__(self):
        self.tracks = ()

    def update(self, frame):  # noqa: ARG002
        return self.tracks


def track(number, left, status=Status.TRACKED):
    return Track(
        id=number, boxes={THERMAL: (left, 60.0, 36.0, 120.0)}, confidence=0.9, status=status, age_s=1.0
    )


class Film:
    """Plays people of one colour each before a scripted tracker; both cameras see the same."""

    def __init__(self, recogniser=None, config=None):
        self.below = Script()
        self.tracker = AttentiveTracker(self.below, recogniser or ByColour(), config)
        self.frame = 0

    def play(self, seconds, *people, light=1.0):
        """Show people (id below, left, colour) for a time; give the numbers in the last image."""
        told = ()
        for _ in range(round(seconds * HZ)):
            self.frame += 1
            drawn = scene(*((left, 60, 120, colour) for _, left, colour in people), seed=self.frame)
            images = {THERMAL: drawn[..., 0], COLOUR: (drawn * light).astype(np.uint8)}
            self.below.tracks = tuple(track(number, left) for number, left, _ in people)
            told = self.tracker.update(Frame(images=images, time_s=self.frame / HZ))
        return {one.boxes[THERMAL][0]: one.id for one in told}


@pytest.mark.slow
def test_who_comes_back_after_a_minute_in_slightly_less_light_has_the_old_number_and_a_stranger_a_new_one():
    film = Film()
    assert film.play(1.0, (1, 60.0, RED)) == {60.0: 1}
    assert film.play(1.0, (1, 60.0, RED), (2, 200.0, GREEN)) == {60.0: 1, 200.0: 2}
    film.play(20.0)
    assert film.play(1.0, (7, 100.0, BLUE)) == {100.0: 3}
    film.play(40.0)
    assert film.play(0.5, (9, 150.0, RED), light=0.8) == {150.0: 1}
    assert film.play(0.5, (9, 150.0, RED), (11, 40.0, GREEN), light=0.8) == {150.0: 1, 40.0: 2}


def test_somebody_else_under_the_same_number_below_is_a_stranger_after_an_absence():
    film = Film()
    film.play(1.0, (1, 60.0, RED))
    film.play(3.0)
    assert film.play(0.5, (1, 60.0, GREEN))[60.0] not in (1,)
    assert film.play(1.0, (2, 200.0, RED))[200.0] == 1


def test_nobody_who_was_there_beside_a_person_is_ever_taken_for_it():
    film = Film()
    both = film.play(1.0, (1, 60.0, RED), (2, 200.0, RED))
    assert film.play(2.0, (2, 200.0, RED)) == {200.0: both[200.0]}


def test_numbers_are_single_and_tentative_people_have_the_next_one():
    film = Film()
    film.play(1.0, (1, 60.0, RED))
    film.below.tracks = (track(1, 60.0), track(2, 150.0, Status.TENTATIVE))
    drawn = scene((60, 60, 120, RED))
    told = film.tracker.update(Frame(images={THERMAL: drawn[..., 0], COLOUR: drawn}, time_s=9.0))
    assert sorted(one.id for one in told) == [one.id for one in told]
    assert len({one.id for one in told}) == 2


@pytest.mark.thorough
def test_attention_as_printed_tells_people_too():
    film = Film(ByFocus(PRINTED), AS_FOUND)
    film.play(1.0, (1, 60.0, RED))
    assert film.play(0.6, (1, 60.0, RED)) == {60.0: 1}
    film.play(3.0)
    assert film.play(0.6, (2, 60.0, RED)) == {60.0: 1}


def test_the_explanation_names_the_one_who_was_learned_first_and_finds_that_one():
    film = Film()
    film.play(1.0, (1, 60.0, RED), (2, 200.0, GREEN))
    told = film.tracker.explanation
    assert told.attended.number == 1
    assert abs(told.attended.focus().place[0] - 78.0) < 12.0
    assert set(told.likeness) == {1, 2}
    assert min(told.likeness.values()) > 0.9


def test_a_person_is_described_by_colours_unless_the_torso_is_outside_or_dark():
    def see(colour, light=1.0, left=60.0):
        image = (scene((60, 60, 120, colour)) * light).astype(np.uint8)
        return ByColour().see(PersonView(COLOUR, image, (left, 60.0, 36.0, 120.0)))

    red, score = see(RED), ByColour().score
    assert score(red, red) == pytest.approx(1.0, abs=1e-5)
    assert score(red, see(GREEN)) == pytest.approx(score(see(GREEN), red))
    assert score(red, see(GREEN)) < 0.51  # the legs are the same
    assert see(RED, light=0.02) is None
    assert see(RED, left=-200.0) is None


def test_a_box_in_the_colour_image_follows_rays_and_place():
    def calibration(aside_m):
        pose = np.array([[0.0, 0, 1, 0.1], [-1, 0, 0, aside_m], [0, -1, 0, 1.2], [0, 0, 0, 1]])
        return PinholeCalibration(np.array([[300.0, 0, 160], [0, 300, 120], [0, 0, 1]]), pose)

    frame = Frame(
        images={COLOUR: scene()},
        time_s=0.0,
        calibrations={THERMAL: calibration(0.0), COLOUR: calibration(0.06)},
    )
    place = FloorPlace(position_m=(4.1, 0.0), covariance_m2=(0.1, 0.0, 0.1))
    seen = Track(
        id=1,
        boxes={THERMAL: (142.0, 80.0, 36.0, 125.0)},
        place=place,
        confidence=1.0,
        status=Status.TRACKED,
        age_s=1.0,
    )
    left, top, width, height = box_in(COLOUR, seen, frame)
    assert left + width / 2.0 == pytest.approx(160.0 + 300.0 * 0.06 / 4.0)
    assert (top, height) == pytest.approx((80.0, 125.0))
    assert box_in(PANORAMA, seen, Frame(images={PANORAMA: scene()}, time_s=0.0)) is None
    # Of a tracker that tells no places the height tells how far away it is, near enough for 6 cm aside.
    unplaced = box_in(COLOUR, replace(seen, place=None), frame)
    assert unplaced == pytest.approx((left, top, width, height), abs=1.0)
    assert box_in(COLOUR, replace(seen, place=None, boxes={}), frame) is None


def test_without_colours_it_is_refused_in_one_line():
    with refused("attention needs a colour camera", "the robot has thermal"):
        AttentiveTracker(Script(), ByColour()).update(Frame(images={THERMAL: scene()[..., 0]}, time_s=0.0))


@pytest.mark.parametrize("name", [name for name in TRACKERS if name.startswith("attentive")])
def test_the_registered_ones_want_colours(name):
    assert {THERMAL, COLOUR} <= set(make_tracker(name).cameras)


def test_settings_out_of_range_are_refused():
    with refused("accept must be in 0..1, got 1.2"):
        AttentiveConfig(accept=1.2)
    with refused("gap_s must be 0 or more, got -1"):
        AttentiveConfig(gap_s=-1)
