"""One number for one person, by trackers that say what a test wants them to."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.contour.box_interaction import standing_box
from peopleboy.tracker.contour.explanation import DETECTOR_KEY, ContourExplanation
from peopleboy.tracker.contour.variants import CONTOUR
from peopleboy.tracker.frame import PANORAMA, THERMAL, Frame
from peopleboy.tracker.fusion.fused_explanations import BothExplanations
from peopleboy.tracker.fusion.handover_tracker import (
    DOUBTFUL_S,
    FARTHEST_M,
    NEEDED_VOTES,
    PAUSE_S,
    HandoverTracker,
)
from peopleboy.tracker.panoramic.people.panoramic_observation import PeopleExplanation
from peopleboy.tracker.track import Status
from tests.helpers.images.cardboard import CAMERA
from tests.helpers.runs.hand_made_tracks import track
from tests.helpers.runs.synthetic_ticks import ELLIPSE

THERMAL_CAMERA = calibrations_of(RobotConfig().cameras)[THERMAL]
BLANK = np.zeros((240, 320), np.uint8)
HIDDEN = Status.TOTALLY_OCCLUDED
SEEN_M, ASIDE_M, BEHIND_M = (4.0, 0.2), (4.0, -1.0), (-3.0, 1.0)


class Saying:
    """A tracker that says what it is told to."""

    def __init__(self, camera):
        self.cameras, self.tracks, self.introduced = (camera,), (), []
        self.explanation = None

    def update(self, frame):
        del frame
        return tuple(self.tracks)

    def introduce(self, box):
        self.introduced.append(box)

    def check_cameras(self, calibrations):
        if PANORAMA not in calibrations:
            raise BadInput("no panorama")


class Both:
    def __init__(self, rate_hz=15):
        self.thermal, self.panoramic = Saying(THERMAL), Saying(PANORAMA)
        self.tracker = HandoverTracker(self.thermal, self.panoramic)
        self.frames, self.rate_hz = 0, rate_hz

    def see(self, thermal=(), panoramic=(), times=1):
        """Let both say this for some frames; the tracks of the last, by number."""
        for _ in range(times):
            self.thermal.tracks, self.panoramic.tracks = thermal, panoramic
            self.frames += 1
            tracks = self.tracker.update(
                Frame(
                    images={THERMAL: BLANK},
                    time_s=self.frames / self.rate_hz,
                    calibrations={THERMAL: THERMAL_CAMERA, PANORAMA: CAMERA},
                )
            )
            assert len({one.id for one in tracks}) == len(tracks)
            # One of each camera at most is one person.
            assert len(tracks) >= max(len(thermal), len(panoramic))
        return {one.id: one for one in tracks}


def warm(number, at=SEEN_M, **further):
    box = standing_box(track(1, at).place, THERMAL_CAMERA)
    return track(number, at, boxes={THERMAL: box}, **further)


def around(number, at=SEEN_M, **further):
    return track(number, at, boxes={PANORAMA: (100.0, 10.0, 20.0, 60.0)}, **further)


def test_it_wants_what_both_want_and_refuses_what_the_panoramic_one_refuses():
    both = Both()
    assert both.tracker.cameras == (THERMAL, PANORAMA)
    with pytest.raises(BadInput):
        both.tracker.check_cameras({})
    both.tracker.check_cameras({PANORAMA: CAMERA})


def test_who_is_seen_by_both_is_one_track_with_both_boxes():
    both = Both()
    (one,) = both.see([warm(4)], [around(9)], times=NEEDED_VOTES).values()
    assert one.id == 1
    assert one.boxes == {**warm(4).boxes, **around(9).boxes}
    assert one.place == around(9).place


def test_of_two_places_the_surer_is_taken():
    both = Both()
    ahead = warm(4, deviation_m=0.05)
    (one,) = both.see([ahead], [around(9)], times=NEEDED_VOTES).values()
    assert one.place == ahead.place


def test_those_who_stand_apart_are_two():
    assert len(Both().see([warm(1, SEEN_M)], [around(1, BEHIND_M)], times=9)) == 2


@pytest.mark.parametrize("first", ["panoramic", "thermal"])
def test_from_one_image_into_the_other_and_back_a_person_keeps_its_number(first):
    both = Both()
    other = around(7, BEHIND_M)
    (number, _) = both.see([], [around(3), other], times=20)
    if first == "thermal":
        both = Both()
        (number,) = both.see([warm(1)], [], times=20)
    reported = both.see([warm(2 if first == "panoramic" else 1)], [around(3), other], times=20)
    assert number in reported
    assert THERMAL in reported[number].boxes
    # Both names change while the other one lasts.
    for thermal, panoramic in (([warm(5)], [around(3)]), ([], [around(3)]), ([warm(6)], [around(3)])):
        reported = both.see(thermal, [*panoramic, other], times=20)
        assert len(reported) == 2
        assert PANORAMA in reported[number].boxes


def test_a_person_keeps_its_number_though_the_panorama_begins_anew_and_the_thermal_image_tells_no_depth():
    both = Both()
    (number,) = both.see([warm(1)], [around(2)], times=20)
    deep = warm(1, (6.4, 0.3))
    for again in (3, 4):
        for age_s in (0.0, 0.5, 2.0):
            (one,) = both.see([deep], [around(again, age_s=age_s)], times=8).values()
            assert one.id == number
            assert one.place == around(again).place
    assert set(both.see([], [around(4)], times=20)) == {number}


def test_whoever_is_seen_behind_a_person_whom_the_panorama_has_lost_is_another_one():
    both = Both()
    behind = around(2, (6.4, 0.3))
    (number,) = both.see([warm(1)], [around(1)], times=20)
    reported = both.see([warm(1)], [behind], times=9)
    assert len(reported) == 2
    assert reported[number].boxes == warm(1).boxes
    reported = both.see([warm(1)], [behind, around(3)], times=9)
    assert len(reported) == 2
    assert reported[number].boxes == {**warm(1).boxes, **around(3).boxes}


def test_a_young_track_of_the_panorama_is_left_out_before_a_person_whom_only_the_thermal_image_shows():
    both = Both()
    deep = warm(1, (10.0, 0.5))
    (number,) = both.see([deep], times=20)
    assert set(both.see([deep], [around(1, age_s=DOUBTFUL_S / 2)])) == {number}
    assert len(both.see([deep], [around(1, age_s=DOUBTFUL_S)])) == 2


def test_a_moment_of_agreement_makes_nobody_one():
    both = Both()
    both.see([warm(1, ASIDE_M)], [around(1, SEEN_M)], times=20)
    both.see([warm(1, SEEN_M)], [around(1, SEEN_M)])
    assert len(both.see([warm(1, ASIDE_M)], [around(1, SEEN_M)], times=3)) == 2


def test_two_who_cross_keep_their_numbers_though_their_places_are_taken_for_each_others_for_a_moment():
    both = Both()
    left, right = (4.0, 0.6), (4.0, -0.6)
    first = both.see([warm(1, left), warm(2, right)], [around(1, left), around(2, right)], times=15)
    assert len(first) == 2
    near = (4.0, 0.05), (4.0, -0.05)
    both.see([warm(1, near[1]), warm(2, near[0])], [around(1, near[0]), around(2, near[1])], times=2)
    reported = both.see([warm(1, right), warm(2, left)], [around(1, right), around(2, left)], times=5)
    for number, at in ((1, right), (2, left)):
        assert reported[number].place.position_m == at
        assert set(reported[number].boxes) == {THERMAL, PANORAMA}


STANDS = st.dictionaries(st.integers(1, 4), st.sampled_from([SEEN_M, ASIDE_M, BEHIND_M]), max_size=3)


@settings(max_examples=150)
@given(st.lists(st.tuples(STANDS, STANDS, st.integers(1, 6)), max_size=6), st.sampled_from([0.2, 5.0]))
def test_two_of_one_camera_never_are_one_person_whoever_comes_and_goes(history, age_s):
    both = Both()
    for ahead, round_about, times in history:
        both.see(
            [warm(number, at, age_s=age_s) for number, at in ahead.items()],
            [around(number, at) for number, at in round_about.items()],
            times=times,
        )


def test_who_comes_back_into_the_thermal_image_is_not_one_with_who_took_its_number():
    both = Both()
    both.see([warm(1)], [around(9)], times=9)
    both.see([warm(2)], [around(9)], times=20)
    assert len(both.see([warm(1, ASIDE_M), warm(2)], [around(9)])) == 2


def test_tentative_ones_of_the_thermal_image_are_left_out():
    both = Both()
    both.see([], [around(1, BEHIND_M)], times=3)
    both.thermal.tracks = [warm(1, status=Status.TENTATIVE)]
    (only,) = both.tracker.update(Frame(images={}, time_s=9.0))
    assert THERMAL not in only.boxes


def test_whoever_is_hidden_is_hidden_by_a_number_that_there_is():
    both = Both()
    reported = both.see([], [around(5, BEHIND_M), around(8, SEEN_M, status=HIDDEN, occluder=5)], times=2)
    hider = next(number for number, one in reported.items() if one.place.position_m == BEHIND_M)
    hidden = next(one for one in reported.values() if one.status is HIDDEN)
    assert hidden.occluder == hider != hidden.id
    reported = both.see([warm(5, status=HIDDEN, occluder=77)], [])
    assert [one.occluder for one in reported.values()] == [None]


def test_who_is_hidden_in_one_image_and_seen_in_the_other_is_seen():
    both = Both()
    both.see([warm(1)], [around(1)], times=9)
    (one,) = both.see([warm(1, status=HIDDEN)], [around(1)]).values()
    assert one.status is Status.TRACKED
    (one,) = both.see([warm(1)], [around(1, ASIDE_M, status=HIDDEN)]).values()
    assert one.status is Status.TRACKED
    assert one.place.position_m == SEEN_M
    (one,) = both.see([warm(1, status=HIDDEN)], [around(1, status=HIDDEN)]).values()
    assert one.status is HIDDEN


def test_who_comes_into_the_thermal_image_is_pointed_out_there():
    both = Both()
    both.see([], [around(1)])
    assert both.thermal.introduced == [standing_box(around(1).place, THERMAL_CAMERA)]


@pytest.mark.parametrize(
    ("thermal", "panoramic"),
    [
        ([], [around(1, BEHIND_M)]),
        ([], [around(1, (0.3, 0.0))]),
        ([], [around(1, (3.0, 3.0))]),
        ([], [around(1, (FARTHEST_M + 0.1, 0.0))]),
        ([], [around(1, status=HIDDEN)]),
        ([], [track(1, None)]),
        ([warm(1)], [around(1)]),
        ([warm(1, (2.0, 0.1))], [around(1)]),
    ],
    ids=["behind", "at the robot", "aside", "far", "hidden", "nowhere", "known", "behind a known one"],
)
def test_who_is_not_to_be_seen_in_the_thermal_image_or_is_known_there_is_not_pointed_out(thermal, panoramic):
    both = Both()
    both.see(thermal, panoramic, times=10)
    assert both.thermal.introduced == []


def test_nobody_is_pointed_out_all_the_time_nor_two_at_once():
    both = Both(rate_hz=20)
    boxes = [standing_box(around(1, at).place, THERMAL_CAMERA) for at in (SEEN_M, ASIDE_M)]
    told_s = {box: [] for box in boxes}
    for frame in range(1, 21):
        both.see([], [around(1, SEEN_M), around(2, ASIDE_M)])
        assert len(both.thermal.introduced) <= 1
        for box in both.thermal.introduced:
            told_s[box].append(frame / 20)
        both.thermal.introduced.clear()
    for times in told_s.values():
        assert len(times) >= 4
        assert np.diff(times).min() >= PAUSE_S - 1e-9


def test_without_a_thermal_image_nobody_is_pointed_out():
    both = Both()
    both.panoramic.tracks = [around(1)]
    for calibrations in ({}, {THERMAL: THERMAL_CAMERA}):
        both.tracker.update(Frame(images={}, time_s=0.0, calibrations=calibrations))
    assert both.thermal.introduced == []


def contours(*numbers):
    return ContourExplanation(
        config=CONTOUR,
        ellipses={number: replace(ELLIPSE, x=float(number)) for number in numbers},
        spread_px2={number: float(number) for number in numbers},
        particles={number: np.zeros(number) for number in (DETECTOR_KEY, *numbers)},
    )


EMPTY = np.zeros((120, 480), np.float32)
PEOPLE = PeopleExplanation(background=np.zeros((120, 480, 3), np.uint8), foreground=EMPTY, covered=EMPTY)


def test_explanations_have_the_numbers_of_the_tracks():
    both = Both()
    both.thermal.explanation, both.panoramic.explanation = contours(3, 5, 6), PEOPLE
    reported = both.see([warm(5), warm(3, ASIDE_M)], [around(8, BEHIND_M), around(9, SEEN_M)], times=5)
    explained = both.tracker.explanation
    assert explained.panoramic is PEOPLE
    shown = {number for number, one in reported.items() if THERMAL in one.boxes}
    assert set(explained.thermal.ellipses) == set(explained.thermal.spread_px2) == shown
    (seen,) = (number for number, one in reported.items() if set(one.boxes) == {THERMAL, PANORAMA})
    assert explained.thermal.ellipses[seen].x == 5.0
    assert set(explained.thermal.particles) == shown | {DETECTOR_KEY}
    assert len(explained.thermal.particles[seen]) == 5


def test_who_has_no_number_is_left_out_of_the_explanation():
    explained = BothExplanations.of(contours(1, 2), None, {2: 7})
    assert set(explained.thermal.ellipses) == {7}
    assert set(explained.thermal.particles) == {7, DETECTOR_KEY}
    assert explained.panoramic is None
