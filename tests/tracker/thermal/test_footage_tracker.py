from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import COLOUR, THERMAL, Frame
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.thermal.variants import FOOTAGE
from peopleboy.tracker.track import Status
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.images.drawn_people import blank, draw_person

GREY, RED, BLUE = (120, 120, 120), (200, 30, 30), (30, 30, 200)


def frame(i, colour):
    """Draw a person in clothes of a colour, or nobody: a thermal picture, and a colour one twice as large."""
    thermal = blank()
    picture = np.full((480, 640, 3), GREY, np.uint8)
    if colour is not None:
        draw_person(thermal, 150, 130, 11, 30)
        picture[2 * 80 : 2 * 195, 2 * 135 : 2 * 165] = colour
    return Frame(images={THERMAL: thermal, COLOUR: picture}, time_s=i / 15)


def ids_of(tracker, colours):
    seen = []
    for i, colour in enumerate(colours):
        tracks = tracker.update(frame(i, colour))
        seen.append({track.id for track in tracks if track.status is Status.TRACKED})
    return seen


@pytest.mark.parametrize(("again", "ids"), [(RED, {1}), (BLUE, {2})])
def test_who_comes_back_in_the_same_colours_keeps_the_number_and_nobody_else_does(again, ids):
    tracker = make_tracker("footage", np.random.default_rng(0))
    seen = ids_of(tracker, [RED] * 25 + [None] * 30 + [again] * 25)
    assert seen[24] == {1}
    assert not any(seen[45:55])
    assert seen[-1] == ids


def test_nobody_who_is_settled_grows_at_once():
    def height_after(config):
        tracker = PeopleTracker(config, np.random.default_rng(1))
        for i in range(60):
            image = blank()
            draw_person(image, 150, 130, 11, 30 if i < 45 else 42)
            tracks = tracker.update(Frame(images={THERMAL: image}, time_s=i / 15))
            if i == 44:
                before = tracks[0].boxes["thermal"][3]
        return tracks[0].boxes["thermal"][3] / before

    free = replace(FOOTAGE, height=replace(FOOTAGE.height, seen_spread=0.0))
    stiff = replace(FOOTAGE, height=replace(FOOTAGE.height, seen_spread=0.02))
    assert height_after(stiff) < 1.12 < 1.3 < height_after(free)
