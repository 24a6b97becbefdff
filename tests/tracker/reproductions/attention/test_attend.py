"""Learning somebody from a box, and looking for that one."""

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.reproductions.attention.attend import attention_map, learn, middle_of, relearn, search
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import TORSO
from tests.helpers.calls.refused import refused

SIZE = (240, 320)
DEFAULT = AttentionConfig()
WAYS = [DEFAULT, AttentionConfig(colour=False), AttentionConfig(maps=False), AttentionConfig(head=False)]
MEANS = AttentionConfig(share="means", reward="more", colour=False)


def scene(*people, seed=0):
    """Draw people (left, top, height, colour of the top) on a noisy grey wall."""
    image = np.random.default_rng(seed).normal(120.0, 3.0, (*SIZE, 3))
    for left, top, height, colour in people:
        middle, wide = left + 0.15 * height, 0.1 * height
        image[int(top) : int(top + 0.13 * height), int(middle - 4) : int(middle + 4)] = (200, 150, 120)
        torso = slice(int(top + 0.16 * height), int(top + 0.5 * height))
        image[torso, int(middle - wide) : int(middle + wide)] = colour
        legs = slice(int(top + 0.5 * height), int(top + height))
        image[legs, int(middle - wide) : int(middle + wide)] = (40, 40, 50)
    return np.clip(image, 0, 255).astype(np.uint8)


RED, GREEN = (190, 40, 40), (40, 150, 60)
BOX = (60.0, 60.0, 36.0, 120.0)
FIRST = scene((60, 60, 120, RED), (200, 60, 120, GREEN))
LATER = scene((220, 70, 120, RED), (90, 50, 120, GREEN), seed=1)


def is_on(place, left, top, height):
    return abs(place[0] - left - 0.15 * height) < 0.1 * height and 0.15 < (place[1] - top) / height < 0.5


@pytest.mark.parametrize("config", WAYS)
def test_the_focus_is_on_who_was_learned_wherever_that_one_is(config):
    model = learn(ImageSums.of(FIRST, config), BOX, config)
    focus = search(ImageSums.of(LATER, config), model, config)
    assert is_on(focus.place, 220, 70, 120)
    assert 0.0 <= focus.second <= focus.score <= 1.0


def test_who_is_nearer_now_is_found_at_another_size():
    model = learn(ImageSums.of(FIRST, DEFAULT), BOX, DEFAULT)
    focus = search(ImageSums.of(scene((140, 50, 150, RED), seed=2), DEFAULT), model, DEFAULT)
    assert is_on(focus.place, 140, 50, 150)


def test_the_default_score_is_absolute_and_the_printed_one_is_not():
    nobody = scene((200, 60, 120, GREEN), seed=3)
    scores = {}
    for config in (DEFAULT, PRINTED):
        model = learn(ImageSums.of(FIRST, config), BOX, config)
        scores[config] = [
            search(ImageSums.of(image, config), model, config).score for image in (LATER, nobody)
        ]
    there, away = scores[DEFAULT]
    assert away < 0.5 * there
    there, away = scores[PRINTED]
    assert away > 0.5 * there


def test_what_excites_and_what_inhibits_add_up_to_all_and_means_do_not_depend_on_the_size_of_the_box():
    flat = ImageSums.of(np.full((*SIZE, 3), 100, np.uint8), MEANS)
    torso = dict(learn(flat, BOX, MEANS).parts)[TORSO]
    assert np.allclose(torso.excites + torso.inhibits, 1.0)
    bright = 8
    assert torso.excites[bright] == pytest.approx(0.5)
    with_sums = replace(PRINTED, share="sums")
    sums = dict(learn(ImageSums.of(flat.image, with_sums), BOX, with_sums).parts)[TORSO]
    assert sums.excites[bright] < 0.02


def test_as_printed_the_learned_torso_stands_out_which_sums_leave_out():
    sight = ImageSums.of(FIRST, PRINTED)
    for share, stands_out in (("means", True), ("sums", False)):
        config = replace(PRINTED, share=share)
        torso = dict(learn(sight, BOX, config).parts)[TORSO]
        assert attention_map(sight, torso, config).any() == stands_out


def test_pixels_behind_the_person_are_no_part_of_what_is_learned():
    sight = ImageSums.of(FIRST, DEFAULT)
    aside, near = (50.0, 60.0, 36.0, 120.0), np.ones(SIZE, np.bool_)
    near[:, :66] = False
    whole, part = (dict(learn(sight, aside, DEFAULT, mask).parts)[TORSO] for mask in (None, near))
    assert np.count_nonzero(part.colours > 0.05) < np.count_nonzero(whole.colours > 0.05)


def test_little_is_learned_anew_and_only_of_a_sure_and_single_place():
    config = AttentionConfig(least=0.2, ahead=0.01)
    first, later = ImageSums.of(FIRST, config), ImageSums.of(LATER, config)
    model = learn(first, BOX, config)
    focus = search(later, model, config)
    new = learn(later, focus.box, config).parts[1][1].mean
    old, mixed = model.parts[1][1].mean, relearn(model, later, focus, config).parts[1][1].mean
    assert np.allclose(mixed, 0.98 * old + 0.02 * new)
    assert relearn(model, later, focus, AttentionConfig(least=0.99)) is model


@pytest.mark.parametrize(
    "box", [(300.0, 60.0, 40.0, 120.0), (60.0, -30.0, 30.0, 120.0), (60.0, 60.0, 0.0, 9.0)]
)
def test_a_box_that_is_not_in_the_image_is_refused_in_one_line(box):
    with refused("head and torso of box", "must be inside the image, 320 x 240"):
        learn(ImageSums.of(FIRST, DEFAULT), box, DEFAULT)


def test_the_middle_of_a_person_is_that_of_its_torso():
    assert middle_of((10.0, 20.0, 30.0, 100.0)) == pytest.approx((25.0, 53.0))
