import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.panoramic.people.band_colours import BANDS, NO_COLOURS, BandColours, look_at
from tests.helpers.images.cardboard import (
    CAMERA,
    GREEN,
    HEIGHT,
    RED,
    WHITE,
    WIDTH,
    Cardboard,
    is_cardboard,
    mask_of,
    panorama,
    scene_of,
)

NOBODY = np.zeros((HEIGHT, WIDTH), np.float32)


def looks_of(person, people=(), light=1.0):
    """The looks of somebody whose pixels are known, under a light."""
    shown = mask_of(person)[0].astype(np.float32)
    image = panorama([person, *people], light)
    return look_at(image, shown, NOBODY, person.bearing_rad, person.distance_m, CAMERA)


def drawn_looks(seed):
    return BandColours(np.random.default_rng(seed).uniform(0.1, 2.0, (BANDS, 3)).astype(np.float32))


@pytest.mark.parametrize("bearing", [0.3, math.pi, -3.1])
def test_looks_are_the_colours_of_trousers_and_shirt_as_shares_of_the_images_mean(bearing):
    person = Cardboard(1.9, bearing, shirt=GREEN, trousers=(60, 50, 40))
    image = panorama([person])
    light = image[::8, ::8].mean()
    colours = look_at(image, is_cardboard(image), NOBODY, bearing, 1.9, CAMERA).colours
    np.testing.assert_allclose(colours[0] * light, (60, 50, 40), atol=0.5)
    np.testing.assert_allclose(colours[1] * light, (60, 50, 40), atol=0.5)
    np.testing.assert_allclose(colours[-1] * light, GREEN, atol=0.5)


@given(st.floats(0.3, 1.1), st.floats(-math.pi, math.pi), st.floats(1.5, 5.0))
def test_more_or_less_light_makes_no_difference(light, bearing, distance):
    person = Cardboard(distance, bearing)
    usual, dim = looks_of(person), looks_of(person, light=light)
    assert np.array_equal(np.isnan(usual.colours), np.isnan(dim.colours))
    np.testing.assert_allclose(dim.colours, usual.colours, atol=0.04)
    assert usual.unlikeness(dim) < 0.2


def test_only_pixels_count_that_are_the_persons_own():
    back, front = Cardboard(4.0, 1.0, shirt=RED), Cardboard(2.0, 1.0 + 0.1, shirt=GREEN)
    scene = scene_of([back, front])
    mixed = scene.clothing(1.0, 4.0)
    scene.cover(front.bearing_rad, front.distance_m)
    assert scene.clothing(1.0, 4.0).unlikeness(looks_of(back)) < 0.6 < mixed.unlikeness(looks_of(back))


def test_of_nobody_there_are_no_looks():
    assert np.isnan(scene_of([]).clothing(0.0, 3.0).colours).all()
    assert math.isnan(NO_COLOURS.unlikeness(drawn_looks(0)))


def test_nobody_is_unlike_itself_and_others_are_by_their_squared_difference_in_spreads():
    one, other = drawn_looks(1), drawn_looks(2)
    assert one.unlikeness(one) == 0.0
    away = (one.colours - other.colours) / (0.055 * (1 + one.colours))
    assert one.unlikeness(other) == pytest.approx(float((away**2).mean()), rel=1e-5)
    part = other.colours.copy()
    part[0] = np.nan
    assert one.unlikeness(BandColours(part)) == pytest.approx(float((away[1:] ** 2).mean()), rel=1e-5)


def test_looks_at_different_clothes_differ_by_far_more_than_those_of_one_person_elsewhere():
    here, there = (looks_of(Cardboard(distance, 2.0)) for distance in (2.0, 3.0))
    other = looks_of(Cardboard(2.0, 2.0, shirt=WHITE))
    assert here.unlikeness(there) < 0.5
    assert here.unlikeness(other) > 10.0


def test_looks_are_learned_slowly_and_what_was_never_seen_is_taken_over_at_once():
    known, newest = drawn_looks(3).colours, drawn_looks(4)
    gap = known.copy()
    gap[2] = np.nan
    learned = BandColours(gap).joined(newest).colours
    assert np.array_equal(learned[2], newest.colours[2])
    way = (learned - known) / (newest.colours - known)
    assert ((way[[0, 1, 3]] > 0) & (way[[0, 1, 3]] < 0.2)).all()
    unseen = BandColours(known).joined(NO_COLOURS)
    assert np.array_equal(unseen.colours, known)
    many = BandColours(known)
    for _ in range(400):
        many = many.joined(newest)
    np.testing.assert_allclose(many.colours, newest.colours, atol=1e-3)
