"""The tracker's decisions, on cardboard people whom stand-ins for what is taught read exactly."""

import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.frame import Frame, Odometry
from peopleboy.tracker.sensors.panorama.panorama_patches import person_box
from peopleboy.tracker.track import Status
from peopleboy.tracker.tracking.config import PANORAMIC
from tests.helpers.calls.refused import refused
from tests.helpers.images.cardboard import (
    BLUE,
    CAMERA,
    GREEN,
    HALL,
    RED,
    WHITE,
    WIDTH,
    Cardboard,
    frame_of,
    is_cardboard,
    panorama,
)
from tests.helpers.images.cardboard_stage import Stage, cardboard_tracker, number_at

RATES = pytest.mark.parametrize("rate_hz", [3, 15])


def still(*people):
    return lambda _: people


ANNA, BERT = Cardboard(2.5, 0.5, shirt=RED), Cardboard(3.5, -2.0, shirt=BLUE)


@RATES
def test_who_stands_there_is_believed_within_a_second_and_placed(rate_hz):
    stage = Stage(rate_hz)
    stage.play(1.0, still(ANNA, BERT))
    tracks = stage.play(1.0, still(ANNA, BERT))[-1]
    assert [track.status for track in tracks] == [Status.TRACKED] * 2
    for person in (ANNA, BERT):
        assert number_at(tracks, person, within_m=0.15) is not None
    for track in tracks:
        x, y = track.place.position_m
        box = person_box(math.atan2(y, x), math.hypot(x, y), CAMERA)
        assert track.boxes["panorama"] == pytest.approx(box, abs=0.5)
        assert 0 < track.confidence <= 1
        assert 1.0 < track.age_s <= 2.0
        xx, xy, yy = track.place.covariance_m2
        assert xx > 0 < xx * yy - xy * xy


def test_nobody_is_believed_at_first_sight_and_who_goes_is_let_go():
    stage = Stage()
    assert stage.show(ANNA) == ()
    stage.play(1.0, still(ANNA))
    assert stage.play(3.0, still())[-1] == ()


@pytest.mark.slow
@RATES
def test_round_the_robot_and_over_the_seam_a_walker_is_one_track(rate_hz):
    stage = Stage(rate_hz)
    begin = math.pi - 1.0

    def walker(time_s):
        return [Cardboard(2.5, begin + 0.35 * time_s)]

    reported = stage.play(18.0, walker)
    assert stage.ever == {1}
    for k, tracks in enumerate(reported):
        time_s = k / rate_hz
        if time_s > 1.0:
            assert number_at(tracks, walker(time_s)[0], within_m=0.3) == 1
    boxes = [tracks[0].boxes["panorama"] for tracks in reported if tracks]
    assert any(left + width > WIDTH - 0.5 for left, _, width, _ in boxes)


@RATES
def test_who_walks_behind_another_one_keeps_its_number(rate_hz):
    stage = Stage(rate_hz)
    front = Cardboard(1.8, 1.0, shirt=GREEN)

    def scene(time_s):
        return front, Cardboard(3.5, 0.4 + 0.2 * time_s, shirt=RED)

    reported = stage.play(6.0, scene)
    early, late = round(1.2 * rate_hz), len(reported) - 1
    number = number_at(reported[early], scene(early / rate_hz)[1])
    assert number == number_at(reported[late], scene(late / rate_hz)[1])
    assert stage.ever == {1, 2}
    assert all(1 in {track.id for track in tracks} for tracks in reported[early:])


@RATES
def test_who_is_hidden_stays_in_mind_and_is_told_who_hides_it(rate_hz):
    stage = Stage(rate_hz)
    back = Cardboard(3.5, 2.0, shirt=RED)

    def scene(time_s):
        # It steps before the other one, waits there for two seconds, and goes on.
        bearing = 1.5 + 0.25 * (min(time_s, 2.0) + max(time_s - 4.0, 0.0))
        return back, Cardboard(1.8, bearing, shirt=GREEN)

    reported = stage.play(6.0, scene)
    number = number_at(reported[round(1.0 * rate_hz)], back)
    occluder = 3 - number
    for tracks in reported[round(2.4 * rate_hz) : round(4.0 * rate_hz)]:
        hidden = next(track for track in tracks if track.id == number)
        assert (hidden.status, hidden.occluder) == (Status.TOTALLY_OCCLUDED, occluder)
        assert number_at([hidden], back) == number
    assert number_at(reported[-1], back) == number
    assert reported[-1][number - 1].status is Status.TRACKED
    assert stage.ever == {1, 2}


@RATES
def test_two_who_pass_each_other_keep_their_numbers(rate_hz):
    stage = Stage(rate_hz)

    def scene(time_s):
        return (
            Cardboard(2.2, -0.7 + 0.25 * time_s, shirt=RED),
            Cardboard(3.4, 0.7 - 0.18 * time_s, shirt=BLUE),
        )

    reported = stage.play(6.0, scene)
    early, late = round(1.2 * rate_hz), len(reported) - 1
    for k in range(2):
        first = number_at(reported[early], scene(early / rate_hz)[k])
        assert first == number_at(reported[late], scene(late / rate_hz)[k])
        assert first is not None
    assert stage.ever == {1, 2}


def test_who_goes_and_comes_back_elsewhere_has_its_old_number_and_another_one_a_new_one():
    stage = Stage()
    first = stage.play(1.5, still(ANNA, BERT))[-1]
    number = number_at(first, ANNA)
    assert len(stage.play(4.0, still(BERT))[-1]) == 1
    back, other = replace(ANNA, bearing_rad=1.6), Cardboard(3.0, 2.6, shirt=WHITE)
    tracks = stage.play(1.5, still(BERT, back, other))[-1]
    assert number_at(tracks, back) == number
    assert number_at(tracks, BERT) == number_at(first, BERT)
    assert number_at(tracks, other) == 3


def test_who_has_been_gone_for_too_long_is_somebody_new():
    existence = replace(PANORAMIC.existence_panorama, forget_s=1.0, brief_forget_s=1.0)
    config = replace(PANORAMIC, existence_panorama=existence)
    stage = Stage(config=config)
    stage.play(1.0, still(ANNA))
    stage.play(4.0, still())
    assert number_at(stage.play(1.0, still(ANNA))[-1], ANNA) == 2


@RATES
def test_a_robot_that_drives_and_turns_knows_who_stands(rate_hz):
    """Nobody moves but the robot; places are told in its frame, numbers stay."""
    stage = Stage(rate_hz)
    people = {"anna": (2.6, 1.0, RED), "bert": (-1.5, 2.5, BLUE)}
    x = y = heading = 0.0
    step = Odometry(advance_m=0.2 / rate_hz, turn_rad=0.4 / rate_hz)
    numbers = {name: set() for name in people}
    for k in range(round(5.0 * rate_hz)):
        if k:
            x += step.advance_m * math.cos(heading)
            y += step.advance_m * math.sin(heading)
            heading += step.turn_rad
        seen = {
            name: Cardboard(math.hypot(a - x, b - y), math.atan2(b - y, a - x) - heading, shirt)
            for name, (a, b, shirt) in people.items()
        }
        tracks = stage.show(*seen.values(), odometry=step if k else Odometry())
        if k > 1.2 * rate_hz:
            for name, one in seen.items():
                numbers[name].add(number_at(tracks, one, within_m=0.3))
    assert sorted(numbers.values(), key=min) == [{1}, {2}]


def test_between_images_tracks_go_on_with_the_robot_and_grow_unsure():
    stage = Stage()
    (seen,) = stage.play(1.5, still(ANNA))[-1]
    turn = Odometry(turn_rad=math.pi / 2)
    (later,) = stage.tracker.update(frame_of(stage.time_s + 0.2, None, turn))
    x, y = seen.place.position_m
    assert later.place.position_m == pytest.approx((y, -x), abs=0.15)
    assert later.id == seen.id
    before, after = (one.place.covariance_m2 for one in (seen, later))
    assert after[0] * after[2] - after[1] ** 2 > before[0] * before[2] - before[1] ** 2
    assert later.age_s == pytest.approx(seen.age_s + 0.2 + 1 / 15)


def test_an_empty_hall_has_nobody_in_it_for_however_long():
    stage = Stage(3)
    assert not any(stage.play(5.0, still()))
    assert stage.ever == set()


def test_it_explains_who_was_taken_for_whom():
    stage = Stage()
    assert stage.tracker.explanation is None
    stage.play(1.0, still(ANNA, BERT))
    reported = stage.tracker.explanation
    assert np.array_equal(reported.foreground, is_cardboard(panorama([ANNA, BERT])))
    assert reported.covered[reported.foreground > 0].mean() > 0.95
    assert not reported.covered[reported.foreground == 0].any()
    assert np.array_equal(reported.background, HALL)


@pytest.mark.parametrize(("other", "words"), [
    (replace(CAMERA, ring_height_m=2.5), ("0.5 to 2 m", "2.50 m")),
    (replace(CAMERA, ring_height_m=0.3), ("0.5 to 2 m", "0.30 m")),
    (replace(CAMERA, axis_rad=0.1), ("floor from 5 m",)),
])  # fmt: skip
def test_a_camera_too_low_or_high_or_without_floor_is_refused(other, words):
    tracker = cardboard_tracker()
    with refused("panoramic camera", *words):
        tracker.check_cameras({"panorama": other})
    with refused("panoramic camera", *words):
        tracker.update(Frame(images={"panorama": HALL}, time_s=0.0, calibrations={"panorama": other}))
    assert tracker.explanation is None


def test_an_image_of_another_size_than_its_calibration_is_refused():
    frame = Frame(images={"panorama": HALL[:100]}, time_s=0.0, calibrations={"panorama": CAMERA})
    with refused("panorama", "480x120", "480x100"):
        cardboard_tracker().update(frame)


def test_a_camera_that_is_flat_or_unknown_is_refused():
    flat = PinholeCalibration(intrinsics=np.eye(3), robot_from_camera=np.eye(4))
    for calibrations in ({}, {"panorama": flat}, {"other": CAMERA}):
        tracker = cardboard_tracker()
        with refused("panorama", "calibrated panoramic camera"):
            tracker.check_cameras(calibrations)
        with refused("panorama", "calibrated panoramic camera"):
            tracker.update(Frame(images={"panorama": HALL}, time_s=0.0, calibrations=calibrations))


@pytest.mark.parametrize("image", [HALL[:, :, 0], HALL.astype(float), np.zeros((0, 0, 3), np.uint8)])
def test_what_is_no_colour_image_is_refused(image):
    tracker = cardboard_tracker()
    with refused("panorama image must be (H, W, 3) uint8"):
        tracker.update(Frame(images={"panorama": image}, time_s=0.0, calibrations={"panorama": CAMERA}))


def test_without_images_there_is_nobody():
    tracker = cardboard_tracker()
    assert tracker.cameras == ("panorama",)
    assert tracker.update(Frame(images={}, time_s=0.0)) == ()
