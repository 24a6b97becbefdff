from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from drawn_people import blank, draw_person

from tracker import crowd, several
from tracker.config import InteractionConfig
from tracker.filter import weigh
from tracker.frame import Frame
from tracker.several import PeopleTracker
from tracker.track import Status
from tracker.variants import PEOPLEBOY

APART = replace(PEOPLEBOY, interaction=InteractionConfig(detector_penalty=1e-9, detector_overlap=0.3))


def frame(i, *people):
    image = blank()
    for x, h in people:
        draw_person(image, x, 120 + 0.36 * h, 0.38 * h, h)
    return Frame(thermal=image, time_s=i / 15)


def confirmed(tracks):
    return [track for track in tracks if track.status is Status.TRACKED]


THREE = ((60, 25), (150, 32), (250, 28))


@pytest.mark.parametrize("seed", range(3))
def test_the_detector_finds_three_people_one_after_the_other(seed):
    tracker = PeopleTracker(APART, np.random.default_rng(seed))
    counts, tracks = [], ()
    for i in range(60):
        tracks = tracker.update(frame(i, *THREE))
        counts.append(len(confirmed(tracks)))
    assert all(later - earlier <= 1 for earlier, later in pairwise(counts))
    assert counts[-1] == 3
    assert sorted(track.ellipse.x for track in confirmed(tracks)) == pytest.approx([60, 150, 250], abs=5)


def test_who_is_no_longer_seen_is_given_up_and_the_others_stay():
    tracker = PeopleTracker(APART, np.random.default_rng(0))
    for i in range(60):
        tracks = tracker.update(frame(i, *THREE))
    gone = min(confirmed(tracks), key=lambda track: track.ellipse.x).id
    for i in range(60, 90):
        tracks = tracker.update(frame(i, *THREE[1:]))
    left = {track.id for track in confirmed(tracks)}
    assert gone not in left
    assert len(left) == 2


def test_with_one_person_allowed_there_is_never_a_second_track():
    config = replace(APART, interaction=replace(APART.interaction, max_persons=1))
    tracker = PeopleTracker(config, np.random.default_rng(0))
    assert all(len(tracker.update(frame(i, *THREE))) <= 1 for i in range(40))


def test_equal_seeds_give_equal_tracks():
    def run():
        tracker = PeopleTracker(APART, np.random.default_rng(5))
        return [tracker.update(frame(i, *THREE)) for i in range(25)]

    assert run() == run()


def test_the_image_is_measured_once_for_each_person_and_once_for_the_detector(monkeypatch):
    calls = []
    for module in (several, crowd):
        monkeypatch.setattr(module, "weigh", lambda *args: calls.append(len(args[0])) or weigh(*args))
    tracker = PeopleTracker(APART, np.random.default_rng(0))
    for i in range(60):
        calls.clear()
        before = len(tracker.particles.keys() - {0})
        tracker.update(frame(i, *THREE))
        assert calls == [1000] * (before + 1)


def test_shared_samples_are_divided_evenly():
    config = replace(APART, interaction=replace(APART.interaction, total_count=900))
    tracker = PeopleTracker(config, np.random.default_rng(0))
    for i in range(60):
        tracker.update(frame(i, *THREE))
    assert [len(cloud) for key, cloud in tracker.particles.items() if key] == [300] * 3
