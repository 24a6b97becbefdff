from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel
from peopleboy.tracker.reproductions.contour.gallery import (
    is_comparable,
    least_mismatch,
    most_alike_and_nearest,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, view_frame
from peopleboy.tracker.reproductions.contour.particles import equally_weighted
from peopleboy.tracker.reproductions.contour.tracked_person import SIZE, TrackedPerson
from peopleboy.tracker.reproductions.contour.variants import CONTOUR
from peopleboy.tracker.track import Status
from tests.helpers.images.drawn_people import blank

VIEW = view_frame(
    Frame(images={THERMAL: blank()}, time_s=1.0),
    1 / 15,
    ContourModel.build((240, 320), CONTOUR.contour),
    CONTOUR,
)


def person(number, x=160.0, h=30.0, colour=0.0, hidden_s=1.0, **more):
    state = np.array([x, 131.0, 0.38 * h, h, 0, 0, 0, 0, 0])
    cloud = equally_weighted(state[None].astype(np.float32))
    model = ColourModel(np.full((1, 12), colour, dtype=np.float32), 10)
    return TrackedPerson(
        id=number,
        born_s=0.0,
        belief=Belief(cloud, cloud, state, 0.9, 1.0),
        shown=state,
        velocity=np.zeros(2),
        foot=190.0,
        size=state[SIZE],
        status=Status.TOTALLY_OCCLUDED,
        hidden_s=hidden_s,
        appearance=model,
        **more,
    )


def test_of_two_at_the_same_place_the_one_with_the_same_looks_is_least_mismatch():
    lost = person(1, colour=0.0), person(2, colour=3.0)
    assert least_mismatch(person(9, colour=3.1), lost, VIEW, CONTOUR) is lost[1]


def test_of_two_with_the_same_looks_the_nearer_one_is_least_mismatch():
    lost = person(1, x=60.0), person(2, x=150.0)
    assert least_mismatch(person(9, x=160.0), lost, VIEW, CONTOUR) is lost[1]


@pytest.mark.parametrize("found", [person(9, colour=5.0), person(9, h=80.0)])
def test_a_stranger_is_nobody_who_was_lost(found):
    assert least_mismatch(found, (person(1, hidden_s=0.3),), VIEW, CONTOUR) is None


def test_the_thesis_asks_that_the_nearest_is_also_the_most_alike():
    near_but_other, far_but_alike = person(1, x=150.0, colour=2.0), person(2, x=60.0, colour=0.0)
    assert most_alike_and_nearest(person(9), (near_but_other, far_but_alike)) is None
    near = person(3, x=155.0, colour=0.1)
    assert (
        most_alike_and_nearest(
            person(9), (near, replace(far_but_alike, appearance=near_but_other.appearance))
        )
        is near
    )


def seen_in_part(number, share):
    """Somebody of whose 12 features a share is known."""
    mean = np.zeros((1, 12), dtype=np.float32)
    mean[:, round(12 * share) :] = np.nan
    return replace(person(number), appearance=ColourModel(mean, 10))


@pytest.mark.parametrize(("share", "is_enough"), [(1.0, True), (0.5, True), (0.4, False), (0.0, False)])
def test_who_is_seen_by_half_of_what_is_known_can_be_compared(share, is_enough):
    assert is_comparable(seen_in_part(9, share), person(1)) is is_enough


def test_what_was_never_known_need_not_be_seen():
    assert is_comparable(seen_in_part(9, 0.3), seen_in_part(1, 0.3))
    assert is_comparable(replace(person(9), appearance=None), person(1))
