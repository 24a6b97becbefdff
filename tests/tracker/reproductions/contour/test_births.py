from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, view_frame
from peopleboy.tracker.reproductions.contour.particles import equally_weighted
from peopleboy.tracker.reproductions.contour.tracked_person import Streak
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, VARIANTS
from tests.helpers.images.drawn_people import blank

VIEW = view_frame(
    Frame(images={THERMAL: blank()}, time_s=1.0),
    1 / 15,
    ContourModel.build((240, 320), CONTOUR.contour),
    CONTOUR,
)
LIFE, SEARCH = CONTOUR.life, CONTOUR.search
LARGE, SMALL = SEARCH.small_h + 1, SEARCH.small_h - 1


def state(x=160.0, h=LARGE):
    return np.array([x, 120 + 0.36 * h, 0.4 * h, h, 0, 0, 0, 0, 0])


def belief(confidence, h=LARGE, spread_px2=10.0):
    cloud = equally_weighted(state(h=h)[None].astype(np.float32))
    return Belief(cloud, cloud, state(h=h), confidence, spread_px2)


def frames_until_born(seen, known=(), config=CONTOUR, most=10):
    streak = Streak()
    for frame in range(1, most):
        streak = streak.after(seen, known, VIEW, config)
        if streak.is_enough(config):
            return frame
    return None


@pytest.mark.parametrize(
    ("confidence", "h", "known", "frames"),
    [
        (SEARCH.clear_confidence + 0.01, LARGE, (), SEARCH.clear_frames),
        (SEARCH.clear_confidence - 0.01, LARGE, (), None),
        (SEARCH.small_confidence + 0.01, SMALL, (), LIFE.birth_frames),
        (SEARCH.small_confidence - 0.01, SMALL, (), None),
        (LIFE.birth_confidence + 0.01, LARGE, [state(x=180.0, h=80.0)], LIFE.birth_frames),
        (LIFE.birth_confidence - 0.01, LARGE, [state(x=180.0, h=80.0)], None),
        (SEARCH.clear_confidence + 0.01, LARGE, [state(x=260.0, h=80.0)], SEARCH.clear_frames),
    ],
)
def test_who_is_large_and_alone_is_told_of_sooner_and_who_is_small_later(confidence, h, known, frames):
    assert frames_until_born(belief(confidence, h), known) == frames


def test_samples_that_do_not_agree_are_no_streak():
    assert frames_until_born(belief(0.99, spread_px2=LIFE.uncertainty_px2)) is None


def test_frames_must_be_in_a_row():
    streak = Streak()
    for confidence in (0.99, 0.1, 0.99):
        streak = streak.after(belief(confidence), (), VIEW, CONTOUR)
        assert not streak.is_enough(CONTOUR)
    assert streak == Streak(frames=1, clear_frames=1)


def test_what_is_small_counts_in_images_of_240_rows():
    doubled = replace(VIEW, image=np.zeros((480, 640), dtype=np.uint8))
    after = Streak().after(belief(0.7, h=LARGE), (), doubled, CONTOUR)
    assert after == Streak()


@pytest.mark.parametrize("name", ["thesis", "thermal", "colour", "paper"])
@pytest.mark.parametrize("known", [(), [state()]])
@pytest.mark.parametrize("h", [6.0, LARGE])
def test_the_sources_treat_all_alike(name, known, h):
    config = VARIANTS[name]
    sure = belief(config.life.birth_confidence + 0.01, h, spread_px2=0.0)
    assert frames_until_born(sure, known, config) == config.life.birth_frames
    assert frames_until_born(belief(config.life.birth_confidence - 0.01, h), known, config) is None
