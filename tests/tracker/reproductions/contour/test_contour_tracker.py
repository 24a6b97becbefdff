import math
from dataclasses import replace
from itertools import chain, pairwise, repeat

import numpy as np
import pytest

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, Odometry
from peopleboy.tracker.reproductions.contour import contour_tracker
from peopleboy.tracker.reproductions.contour.contour_config import InteractionConfig
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.occlusion.coasting import WalkOn
from peopleboy.tracker.reproductions.contour.particle_filter import weigh
from peopleboy.tracker.reproductions.contour.particles import X
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, VARIANTS
from peopleboy.tracker.track import Status
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.images.contours import middle, semi_height
from tests.helpers.images.drawn_people import blank, draw_person
from tests.helpers.some_of import some_of

ROBOTS_OWN = Pinhole().calibration
APART = replace(CONTOUR, interaction=InteractionConfig(detector_penalty=1e-9, detector_overlap=0.3))


def frame(i, *people):
    image = blank()
    for x, h in people:
        draw_person(image, x, 120 + 0.36 * h, 0.38 * h, h)
    return Frame(images={THERMAL: image}, calibrations={THERMAL: ROBOTS_OWN}, time_s=i / 15)


def confirmed(tracks):
    return [track for track in tracks if track.status is Status.TRACKED]


THREE = ((60, 25), (150, 32), (250, 28))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_the_detector_finds_three_people_one_after_the_other(seed):
    tracker = ContourTracker(APART, np.random.default_rng(seed))
    counts, tracks = [], ()
    for i in range(60):
        tracks = tracker.update(frame(i, *THREE))
        counts.append(len(confirmed(tracks)))
    assert all(later - earlier <= 1 for earlier, later in pairwise(counts))
    assert counts[-1] == 3
    assert sorted(middle(track) for track in confirmed(tracks)) == pytest.approx([60, 150, 250], abs=5)


def test_who_is_no_longer_seen_is_given_up_and_the_others_stay():
    tracker = ContourTracker(APART, np.random.default_rng(0))
    for i in range(60):
        tracks = tracker.update(frame(i, *THREE))
    gone = min(confirmed(tracks), key=middle).id
    for i in range(60, 90):
        tracks = tracker.update(frame(i, *THREE[1:]))
    left = {track.id for track in confirmed(tracks)}
    assert gone not in left
    assert len(left) == 2


def test_equal_seeds_give_equal_tracks():
    def run():
        tracker = ContourTracker(APART, np.random.default_rng(5))
        return [tracker.update(frame(i, *THREE)) for i in range(25)]

    assert run() == run()


def test_the_image_is_measured_once_for_each_person_and_in_each_look_of_the_detector(monkeypatch):
    calls = []
    monkeypatch.setattr(contour_tracker, "weigh", lambda *args: calls.append(len(args[0])) or weigh(*args))
    tracker = ContourTracker(APART, np.random.default_rng(0))
    for i in range(60):
        calls.clear()
        before = len(tracker.explanation.particles.keys() - {0})
        tracker.update(frame(i, *THREE))
        assert calls == [1000] * (before + APART.search.scans)


def searching(scans, **changes):
    """A tracker in which nobody is ever born, so that its detector goes on."""
    detector = replace(CONTOUR.detector, **changes)
    search = replace(CONTOUR.search, scans=scans, clear_frames=99)
    life = replace(CONTOUR.life, birth_frames=99)
    config = replace(CONTOUR, detector=detector, search=search, life=life)
    return ContourTracker(config, np.random.default_rng(0))


def samples_after(tracker, frames):
    for seen in frames:
        tracker.update(seen)
    return tracker.explanation.particles[0].state


def test_two_looks_at_an_image_are_worth_two_images():
    once, twice = searching(scans=1), searching(scans=2)
    frames = [frame(i, (100, 30)) for i in range(6)]
    assert np.array_equal(samples_after(once, frames), samples_after(twice, frames[:3]))


def test_the_camera_turns_once_in_however_many_looks():
    turn_rad = 0.2
    (focal_px, _, centre_px), *_ = ROBOTS_OWN.intrinsics.tolist()
    x = centre_px + focal_px * math.tan(turn_rad + math.atan((100 - centre_px) / focal_px))
    turned = replace(frame(2, (x, 30)), odometry=Odometry(turn_rad=turn_rad))
    tracker = searching(scans=2, fresh_share=0.0)
    states = samples_after(tracker, (frame(0, (100, 30)), frame(1, (100, 30)), turned))
    assert np.median(states[:, X]) == pytest.approx(x, abs=4)


def test_shared_samples_are_divided_evenly():
    config = replace(APART, interaction=replace(APART.interaction, total_count=900))
    tracker = ContourTracker(config, np.random.default_rng(0))
    for i in range(60):
        tracker.update(frame(i, *THREE))
    assert [len(cloud) for key, cloud in tracker.explanation.particles.items() if key] == [300] * 3


BLUE, RED = (30, 60, 200), (200, 40, 40)


def dressed(i, *people):
    """Draw people from back to front, with torsos of their own colour and warmth."""
    thermal, colour = blank(), np.full((240, 320, 3), 90, dtype=np.uint8)
    for x, h, rgb, grey in people:
        mask = blank()
        draw_person(mask, x, 120 + 0.36 * h, 0.38 * h, h)
        is_person = mask > 100
        thermal[is_person] = mask[is_person]
        rows = np.arange(240)[:, None]
        is_torso = is_person & (rows > 120 - 0.6 * h) & (rows < 120 + 1.2 * h)
        thermal[is_torso] = grey
        # The colour camera sees the middle 1/1.2 of the thermal image.
        v, u = np.nonzero(is_torso)
        at = np.rint(1.2 * np.stack([v, u]) - 0.1 * np.array([[240], [320]])).astype(int)
        inside = (at >= 0).all(axis=0) & (at[0] < 240) & (at[1] < 320)
        for down in (0, 1):
            for right in (0, 1):
                row, column = np.minimum(at[0] + down, 239), np.minimum(at[1] + right, 319)
                colour[row[inside], column[inside]] = rgb
    return Frame(images={THERMAL: thermal, COLOUR: colour}, time_s=i / 15)


def passing(i):
    """One stands in front; another walks past behind and is wholly hidden on the way."""
    walker = (60 + 2.2 * max(0, i - 30), 18, RED, 150)
    return dressed(i, walker, (160, 50, BLUE, 110))


def identity_at(tracks, x):
    near = [track for track in tracks if abs(middle(track) - x) < 12 and semi_height(track) < 30]
    return near[0].id if near else None


@pytest.mark.parametrize("seed", some_of(range(2), 2))
def test_a_person_keeps_its_identity_through_a_total_occlusion(seed):
    tracker = ContourTracker(CONTOUR, np.random.default_rng(seed))
    tracks = [tracker.update(passing(i)) for i in range(-60, 115)]
    before, after = identity_at(tracks[60 + 45], 60 + 2.2 * 15), identity_at(tracks[-1], 60 + 2.2 * 84)
    assert before is not None
    assert after == before
    hidden = [t for frame in tracks for t in frame if t.status is Status.TOTALLY_OCCLUDED]
    front = next(track.id for track in tracks[60 + 45] if semi_height(track) > 35)
    assert {t.id for t in hidden} == {before}
    assert {t.occluder for t in hidden} <= {front, None}


def stopping(i, stops_s):
    """As `passing`, but the walker stays behind the one in front for a while."""
    walked = min(i, 45) + max(0, i - 45 - round(15 * stops_s))
    return dressed(i, (61 + 2.2 * walked, 18, RED, 150), (160, 50, BLUE, 110))


@pytest.mark.slow
def test_who_stops_behind_somebody_large_is_not_claimed_for_long_and_yet_known_again():
    tracker = ContourTracker(CONTOUR, np.random.default_rng(0))
    tracks = [tracker.update(stopping(i, stops_s=3)) for i in range(125)]
    walker = identity_at(tracks[30], 61 + 2.2 * 30)
    assert identity_at(tracks[42], 61 + 2.2 * 42) == walker
    assert {identity_at(frame, 160) for frame in tracks[60:90]} == {None}
    assert identity_at(tracks[-1], 61 + 2.2 * 79) == walker


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "is_known"), [(4, True), (12, False)])
def test_who_was_lost_is_remembered_for_ten_seconds(seconds, is_known):
    tracker = ContourTracker(CONTOUR, np.random.default_rng(1))
    gone = 40 + round(15 * seconds)
    for i in range(40):
        before = tracker.update(dressed(i, (150, 30, RED, 140)))
    for i in range(40, gone):
        tracker.update(dressed(i))
    for i in range(gone, gone + 30):
        after = tracker.update(dressed(i, (150, 30, RED, 140)))
    assert (confirmed(before)[0].id == confirmed(after)[0].id) is is_known


def test_who_cannot_be_compared_yet_has_a_new_number_until_it_is_known_again(monkeypatch):
    answers = chain([False] * 5, repeat(True))
    monkeypatch.setattr(WalkOn, "can_compare", lambda *_: next(answers))
    tracker = ContourTracker(CONTOUR, np.random.default_rng(1))
    for i in range(40):
        tracker.update(dressed(i, (150, 30, RED, 140)))
    for i in range(40, 100):
        tracker.update(dressed(i))
    back = [tracker.update(dressed(i, (150, 30, RED, 140))) for i in range(100, 130)]
    ids = [confirmed(tracks)[0].id for tracks in back if confirmed(tracks)]
    assert ids == [2] * 5 + [1] * (len(ids) - 5)
    assert all(len(confirmed(tracks)) <= 1 for tracks in back)


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_every_contour_tracker_gives_finite_tracks_with_ids_of_their_own(name):
    tracker = make_tracker(name, 3)
    for i in range(30, 90, 2):
        tracks = tracker.update(passing(i))
        assert len({track.id for track in tracks}) == len(tracks)
        assert np.isfinite([track.boxes["thermal"] for track in tracks]).all()
        assert all(track.boxes["thermal"][2] >= 0 and track.boxes["thermal"][3] >= 0 for track in tracks)


def heat_alone(frame):
    return replace(frame, images={THERMAL: frame.grey(THERMAL)})


@pytest.mark.slow
def test_without_a_colour_camera_people_are_told_apart_by_their_warmth():
    tracker = ContourTracker(CONTOUR, np.random.default_rng(0))
    tracks = [tracker.update(heat_alone(passing(i))) for i in range(115)]
    assert identity_at(tracks[45], 60 + 2.2 * 15) == identity_at(tracks[-1], 60 + 2.2 * 84) is not None
