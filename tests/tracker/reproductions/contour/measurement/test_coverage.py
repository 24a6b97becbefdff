import numpy as np
import pytest

from peopleboy.tracker.reproductions.contour.measurement.contour import SECTIONS
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    COVERED,
    ContourModel,
    body_share,
    cover,
    covered_by,
    head_share,
    seen_shares,
    uncovered,
)
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from tests.helpers.images.drawn_people import blank, draw_person

MODEL = ContourModel.build((240, 320), CONTOUR.contour)


def state(x=160.0, h=30.0, w=None):
    return np.array([x, 120 + 0.36 * h, 0.38 * h if w is None else w, h, 0, 0, 0, 0, 0])


def test_no_pixel_is_marked_before_anybody_is():
    image = np.arange(256, dtype=np.uint8).reshape(16, 16)
    assert (uncovered(image) != COVERED).all()
    assert (uncovered(image)[image > 0] == image[image > 0]).all()


def test_a_person_covers_its_own_drawing():
    image = blank()
    draw_person(image, 160, 120 + 0.36 * 30, 0.38 * 30, 30)
    marked = covered_by(image, [state()], 1.1)
    assert (marked[image > 100] == COVERED).mean() > 0.99
    assert (marked == COVERED).sum() < 2 * (image > 100).sum()


def test_nothing_is_hidden_by_somebody_far_aside_and_all_by_somebody_large():
    far = covered_by(blank(), [state(x=40.0)])
    assert (seen_shares(far, state(), MODEL.probes) == 1).all()
    large = covered_by(blank(), [state(h=90.0)])
    shares = seen_shares(large, state(h=20.0), MODEL.probes)
    assert head_share(shares) == 0
    assert body_share(shares) == 0


def test_somebody_half_aside_hides_one_side_and_leaves_the_other():
    beside = covered_by(blank(), [state(x=130.0, h=60.0)])
    shares = seen_shares(beside, state(h=30.0), MODEL.probes)
    assert len(shares) == SECTIONS
    assert 0.2 < body_share(shares) < 0.9


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_an_impossible_person_covers_nothing(wrong):
    image = uncovered(blank())
    cover(image, np.full(9, wrong))
    assert (image != COVERED).all()


def test_covered_points_count_what_they_are_told_to_and_no_other_does():
    samples = state(h=20.0)[None].astype(np.float32)
    covered = covered_by(blank(), [state(h=90.0)])
    differences = MODEL.differences(covered, samples, 0.4)
    assert differences[0, :7] == pytest.approx(np.full(7, 0.4))
    plain = MODEL.differences(uncovered(blank()), samples, 0.4)
    assert plain == pytest.approx(MODEL.differences(uncovered(blank()), samples))
