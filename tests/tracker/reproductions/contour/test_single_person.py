import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame, Odometry
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.single_filter import NEW_PERSON_S
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS
from peopleboy.tracker.track import Status
from peopleboy.tracker.trackers import TRACKERS, make_tracker
from tests.helpers.calls.refused import refused
from tests.helpers.images.contours import head_top, middle, semi_height
from tests.helpers.images.drawn_people import RADIATOR, blank, draw_person, person_frame
from tests.helpers.import_graph import ROOT

SEEDS = range(3)


NAMES = ("contour", "thesis-single", "paper-single")


def confirmed(tracks):
    return [track for track in tracks if track.status is Status.TRACKED]


def make(name="contour", seed=0):
    return make_tracker(name, seed)


def follow(frames, seed=0, name="contour"):
    tracker = make(name, seed)
    return [tracker.update(frame) for frame in frames]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("x", "h"), [(80.0, 18.0), (150.0, 28.0), (240.0, 45.0)])
def test_a_drawn_person_is_found_at_its_place(x, h, seed):
    tracks = confirmed(follow([person_frame(i / 15, x, h) for i in range(25)], seed)[-1])
    assert len(tracks) == 1
    assert middle(tracks[0]) == pytest.approx(x, abs=0.12 * h)
    assert head_top(tracks[0]) == pytest.approx(120 + 0.36 * h - h * (1 + 2 / 4.4), abs=0.15 * h)
    assert semi_height(tracks[0]) == pytest.approx(h, rel=0.2)
    assert tracks[0].confidence > 0.6


@pytest.mark.parametrize("seed", SEEDS)
def test_a_person_is_confirmed_within_a_second(seed):
    tracks = follow([person_frame(i / 15) for i in range(15)], seed)
    assert confirmed(tracks[-1])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("grey", [0, 20, 255])
def test_nobody_is_found_in_a_uniform_image(name, grey):
    frames = [Frame(images={THERMAL: np.full((240, 320), grey, np.uint8)}, time_s=i / 15) for i in range(30)]
    assert not any(confirmed(tracks) for tracks in follow(frames, name=name))


@pytest.mark.parametrize("seed", SEEDS)
def test_nobody_is_found_among_radiators_and_lamps(seed):
    image = blank()
    image[130:190, 40:140] = RADIATOR
    image[60:70, 200:300] = RADIATOR
    image[100:200, 250:256] = RADIATOR
    image[105:125, 180:205] = 150
    frames = [Frame(images={THERMAL: image}, time_s=i / 15) for i in range(45)]
    assert not any(confirmed(tracks) for tracks in follow(frames, seed))


def test_a_walking_person_keeps_one_id_and_a_box_near_the_truth():
    frames = [person_frame(i / 15, 60 + 2.0 * i) for i in range(90)]
    tracks = follow(frames)
    found = [(i, confirmed(t)[0]) for i, t in enumerate(tracks) if confirmed(t)]
    assert {track.id for _, track in found} == {1}
    assert len(found) > 70
    late = [
        (track.boxes["thermal"][0] + track.boxes["thermal"][2] / 2) - (60 + 2.0 * i)
        for i, track in found[10:]
    ]
    assert np.abs(late).max() < 6


@pytest.mark.parametrize(("name", "later"), [("contour", 1)])
def test_a_person_who_was_lost_comes_back_as_itself_if_it_is_remembered(name, later):
    frames = [person_frame(i / 15) for i in range(20)]
    frames += [Frame(images={THERMAL: blank()}, time_s=i / 15) for i in range(20, 45)]
    frames += [person_frame(i / 15) for i in range(45, 70)]
    tracks = follow(frames, name=name)
    assert [confirmed(tracks[i])[0].id for i in (19, 69)] == [1, later]
    assert not tracks[44]


@pytest.mark.parametrize("name", ["thesis-single", "paper-single"])
def test_one_filter_keeps_its_samples_through_images_without_a_person(name):
    tracker = make(name)
    for i in range(60):
        found = tracker.update(person_frame(i / 15))
    assert [track.id for track in found] == [1]
    for i in range(60, 75):
        found = tracker.update(Frame(images={THERMAL: blank()}, time_s=i / 15))
    assert not found
    assert len(tracker.explanation.particles[1]) == THESIS.person.count
    again = [tracker.update(person_frame(i / 15)) for i in range(75, 90)]
    assert {track.id for tracks in again for track in tracks} == {1}


def test_one_filter_gives_a_new_id_after_a_longer_absence():
    tracker = make("thesis-single")
    pause = round(NEW_PERSON_S * 15) + 2
    frames = [person_frame(i / 15) for i in range(60)]
    frames += [Frame(images={THERMAL: blank()}, time_s=i / 15) for i in range(60, 60 + pause)]
    frames += [person_frame(i / 15) for i in range(60 + pause, 120 + pause)]
    assert {track.id for frame in frames for track in tracker.update(frame)} == {1, 2}


def test_one_filter_never_has_two_tracks_and_refuses_a_time_that_does_not_go_on():
    tracker = make("thesis-single")
    both = np.maximum(person_frame(0.0, 80.0).images[THERMAL], person_frame(0.0, 240.0).images[THERMAL])
    frames = [Frame(images={THERMAL: both}, time_s=i / 15) for i in range(90)]
    assert max(len(tracker.update(frame)) for frame in frames) == 1
    with refused("time_s must go forward"):
        tracker.update(Frame(images={THERMAL: both}, time_s=1.0))


def test_odometry_keeps_the_person_through_a_turn_that_jumps_far():
    step = 25.0

    def frames(turn):
        return [
            Frame(
                images=person_frame(0.0, x=250 - step * max(0, i - 20)).images,
                time_s=i / 15,
                odometry=Odometry(turn_rad=turn(i)),
            )
            for i in range(28)
        ]

    known = follow(frames(lambda i: -np.arctan(step / 297) if i > 20 else 0.0))
    track = confirmed(known[-1])[0]
    assert track.id == 1
    assert middle(track) == pytest.approx(250 - 7 * step, abs=8)


def test_a_person_cut_by_the_lower_border_stays_tracked():
    frames = [person_frame(i / 15, 160, 40 + 0.4 * i) for i in range(110)]
    track = confirmed(follow(frames)[-1])[0]
    assert track.id == 1
    assert semi_height(track) == pytest.approx(40 + 0.4 * 109, rel=0.2)


def test_an_image_of_twice_the_size_gives_a_person_of_twice_the_size():
    image = blank(480, 640)
    draw_person(image, 300, 240 + 0.36 * 56, 0.38 * 56, 56)
    tracks = follow([Frame(images={THERMAL: image}, time_s=i / 15) for i in range(25)])[-1]
    assert semi_height(confirmed(tracks)[0]) == pytest.approx(56, rel=0.2)


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_gives_the_same_tracks_and_another_seed_does_not(name):
    frames = [person_frame(i / 15, 60 + i) for i in range(30)]
    assert follow(frames, 5, name) == follow(frames, 5, name)
    clouds = []
    for seed in (5, 6):
        tracker = make(name, seed)
        for frame in frames:
            tracker.update(frame)
        clouds.append(next(iter(tracker.explanation.particles.values())).state)
    assert not np.array_equal(*clouds)


@pytest.mark.thorough
def test_a_fresh_process_gives_the_same_tracks():
    code = (
        "from tests.helpers.images.drawn_people import person_frame; "
        "from tests.tracker.reproductions.contour.test_single_person import make; t = make(seed=5); "
        "print([t.update(person_frame(i / 15, 60 + i)) for i in range(20)])"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", code]
    other = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
    assert other.strip() == str(follow([person_frame(i / 15, 60 + i) for i in range(20)], 5))


def test_particles_are_those_of_the_detector_first_and_of_the_person_then():
    tracker = make()
    tracker.update(Frame(images={THERMAL: blank()}, time_s=0.0))
    assert set(tracker.explanation.particles) == {0}
    for i in range(1, 20):
        tracker.update(person_frame(i / 15))
    assert set(tracker.explanation.particles) == {0, 1}
    cloud = tracker.explanation.particles[1]
    assert len(cloud) == CONTOUR.person.count
    assert cloud.weight.sum() == pytest.approx(1, abs=1e-4)
    with pytest.raises(ValueError, match="read-only"):
        cloud.state[0, 0] = 0


@pytest.mark.parametrize("second", [1.0, 0.5])
def test_time_that_does_not_go_forward_is_refused(second):
    tracker = make("thesis")
    tracker.update(Frame(images={THERMAL: blank()}, time_s=1.0))
    with refused("time_s", second):
        tracker.update(Frame(images={THERMAL: blank()}, time_s=second))


def test_an_unknown_tracker_is_refused_with_the_names_of_those_that_exist():
    with refused("'best'", *TRACKERS):
        make_tracker("best")


def test_a_filter_of_300_samples_finds_the_person_too():
    config = replace(CONTOUR, person=replace(CONTOUR.person, count=300))
    tracker = ContourTracker(config, np.random.default_rng(0))
    tracks = [tracker.update(person_frame(i / 15)) for i in range(25)]
    assert confirmed(tracks[-1])
