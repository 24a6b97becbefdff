import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.reproductions.panoramic.depth_cues import (
    CLEAN,
    LITERAL,
    Subtraction,
    bearing,
    covering_arc,
    learn_background,
    measure,
)
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_panoramas import HEIGHT, WIDTH, draw, empty_hall, person_mask

COLUMN_RAD = math.tau / WIDTH


def empty_images(seed=0, count=5):
    rng = np.random.default_rng(seed)
    return [empty_hall(rng) for _ in range(count)]


def turned(one, other):
    return math.remainder(one - other, math.tau)


def test_the_background_is_the_mean_of_the_empty_images():
    images = empty_images()
    background = learn_background(images)
    np.testing.assert_allclose(background.mean, np.mean(images, axis=0, dtype=float))


def test_the_threshold_is_the_greatest_difference_of_an_empty_image_from_the_mean_of_the_others():
    images = np.array(empty_images(count=3), float)
    others = [np.delete(images, i, axis=0).mean(axis=0) for i in range(3)]
    greatest = max(np.abs(image - other)[..., 1].max() for image, other in zip(images, others, strict=True))
    assert learn_background(empty_images(count=3)).threshold[1] == pytest.approx(greatest)


def test_the_literal_threshold_is_four_deviations_of_the_grey_difference():
    threshold = learn_background(empty_images(), LITERAL).threshold
    # Grey weighs the channels by .299, .587, .114; rounding to whole levels adds 1/12 each time.
    noise = math.sqrt((4 + 1 / 12) * (0.299**2 + 0.587**2 + 0.114**2) + 1 / 12)
    assert threshold == pytest.approx([4 * noise * math.sqrt(1 + 1 / 4)], rel=0.02)


def test_an_empty_hall_has_no_silhouette_but_for_the_literal_threshold():
    background = {name: learn_background(empty_images(), name) for name in (CLEAN, LITERAL)}
    rng = np.random.default_rng(7)
    noise = {
        name: sum(b.silhouette(empty_hall(rng)).sum() for _ in range(9)) for name, b in background.items()
    }
    assert noise[CLEAN] == 0
    assert noise[LITERAL] > 0


def test_clothes_of_the_floors_grey_are_seen_by_their_colour():
    images = empty_images()
    mask = person_mask(2.0, 0.3)
    # As grey as the row behind, in another colour.
    same_grey = images[0].astype(float)
    same_grey[mask] += np.array([60.0, -60.0 * (0.299 - 0.114) / 0.587, -60.0])
    seen = {
        s: learn_background(images, s).silhouette(np.uint8(np.clip(same_grey, 0, 255)))
        for s in (CLEAN, LITERAL)
    }
    assert seen[CLEAN][mask].mean() > 0.95
    assert seen[LITERAL][mask].mean() < 0.05


def test_a_median_does_not_stop_at_the_seam():
    images = [np.zeros((HEIGHT, WIDTH, 3), np.uint8)] * 5
    image = images[0].copy()
    image[50:60, [0, 1, -2, -1]] = 255
    seen = learn_background(images, Subtraction(is_colour=True, deviations=None, median_px=3)).silhouette(
        image
    )
    assert seen[52:58, [0, -1]].all()


def test_an_image_of_another_size_is_refused():
    with refused("240x60", "480x120"):
        learn_background(empty_images()).silhouette(np.zeros((60, 240, 3), np.uint8))


def test_a_drawn_person_is_measured_in_closed_form():
    mask = np.zeros((HEIGHT, WIDTH), bool)
    mask[20:60, 100:110] = mask[60:90, 100:103] = mask[60:80, 107:110] = True
    figure = measure(mask)
    assert figure.cues == (10.0, HEIGHT - 1 - 89, 400 + 90 + 60)
    assert figure.box == (99.5, 19.5, 10.0, 70.0)
    assert figure.mean_column == pytest.approx((400 * 104.5 + 90 * 101 + 60 * 108) / 550)
    assert figure.bearing_rad == pytest.approx(math.pi - COLUMN_RAD * (figure.mean_column + 0.5))


def test_the_middle_of_the_image_is_ahead_and_its_left_half_is_to_the_left():
    assert bearing((WIDTH - 1) / 2, WIDTH) == pytest.approx(0.0)
    assert bearing(WIDTH / 4 - 0.5, WIDTH) == pytest.approx(math.pi / 2)
    assert bearing(-0.5, WIDTH) == pytest.approx(math.pi)


@given(st.integers(0, WIDTH - 1), st.floats(1.3, 6.0), st.floats(-3.0, 3.0))
def test_rolling_the_image_turns_the_angle_by_as_many_columns_and_changes_no_cue(by, distance, angle):
    mask = person_mask(distance, angle)
    before, after = measure(mask), measure(np.roll(mask, by, axis=1))
    assert after.cues == before.cues
    assert (
        turned(before.bearing_rad, after.bearing_rad) == pytest.approx(turned(by * COLUMN_RAD, 0.0), abs=1e-9)
        or abs(by * COLUMN_RAD - math.pi) < 1e-9
    )
    left, top, width, height = before.box
    assert after.box == ((left + 0.5 + by) % WIDTH - 0.5, top, width, height)
    assert -math.pi < after.bearing_rad <= math.pi


@given(st.floats(1.3, 6.0), st.floats(-3.1, 3.1))
def test_a_person_is_seen_where_drawn_to_a_column(distance, angle):
    figure = measure(person_mask(distance, angle))
    assert abs(turned(figure.bearing_rad, angle)) < COLUMN_RAD


@given(st.sets(st.integers(0, 29), min_size=1))
def test_the_arc_is_the_shortest_of_all_that_hold_every_filled_column(filled):
    columns = np.isin(np.arange(30), list(filled)).astype(int)
    first, width = covering_arc(columns)
    assert filled <= {(first + i) % 30 for i in range(width)}
    shorter = [{(start + i) % 30 for i in range(width - 1)} for start in range(30)]
    assert not [arc for arc in shorter if filled <= arc]


def test_farther_people_stand_higher_and_are_smaller():
    far_to_near = [measure(person_mask(distance, 0.4)).cues for distance in (6.0, 4.0, 3.0, 2.0, 1.5)]
    width, gap, area = np.array(far_to_near).T
    assert (np.diff(width) > 0).all()
    assert (np.diff(gap) < 0).all()
    assert (np.diff(area) > 0).all()


def test_who_has_fewer_pixels_than_asked_for_is_nobody():
    mask = np.zeros((HEIGHT, WIDTH), bool)
    assert measure(mask) is None
    mask[3, :7] = True
    assert measure(mask, 8) is None
    assert measure(mask, 7) is not None


def test_noise_in_a_low_row_is_a_foot_to_the_literal_reading_alone():
    images = empty_images()
    image = draw(empty_hall(np.random.default_rng(9)), person_mask(3.0, 0.0))
    image[HEIGHT - 1, 5] = 255
    gaps = [measure(learn_background(images, s).silhouette(image)).cues.gap_px for s in (LITERAL, CLEAN)]
    assert gaps[0] == 0
    assert gaps[1] == measure(person_mask(3.0, 0.0)).cues.gap_px
