from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.studies.training.detector import augmentation
from peopleboy.studies.training.detector.augmentation import (
    add_texture,
    augment,
    change_span,
    crop,
    dim_people,
    mirror,
    soften,
    take_rows,
)
from peopleboy.studies.training.detector.clutter import add_light, blacken_borders, inscribe, put_in_front
from peopleboy.studies.training.detector.electronics import equalise, sharpen, simulate_electronics
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind
from tests.helpers.images.drawn_films import drawn_film


def test_boxes_to_learn_from_are_those_of_the_film_as_wide_as_the_torso(shots: list[ThermalImage]) -> None:
    for shot, box in zip(shots, drawn_film(0).box, strict=False):
        np.testing.assert_array_equal(shot.box, [box])
        assert shot.is_good.all()


@pytest.mark.parametrize(
    ("visible", "inside", "is_upright", "is_good"),
    [
        (1.0, 1.0, True, True),
        (0.5, 1.0, True, True),
        (0.36, 0.6, True, True),
        (0.4, 1.0, True, False),  # mostly hidden
        (0.3, 0.6, True, False),  # hidden, and cut off
        (0.45, 0.45, True, False),  # cut off
        (1.0, 1.0, False, False),  # low
    ],
)
def test_who_is_partly_hidden_can_be_learned_from_and_who_mostly_is_cannot(
    visible: float, inside: float, is_upright: bool, is_good: bool, tmp_path: Path
) -> None:
    film = drawn_film(0, 1)
    film.visible[:], film.inside[:], film.is_upright[:] = visible, inside, is_upright
    film.save(tmp_path / "film.npz")
    assert [shot.is_good.tolist() for shot in load_images([tmp_path / "film.npz"])] == [[is_good]]


def test_of_whom_nothing_is_seen_nobody_is_told(tmp_path: Path) -> None:
    film = drawn_film(0, 1)
    film.shown_px[:] = 8.0
    film.save(tmp_path / "film.npz")
    assert len(load_images([tmp_path / "film.npz"])[0].box) == 0


def test_a_shot_mirrored_twice_is_itself(shots: list[ThermalImage]) -> None:
    again = mirror(mirror(shots[0]))
    np.testing.assert_array_equal(again.grey, shots[0].grey)
    np.testing.assert_array_equal(again.change, shots[0].change)
    np.testing.assert_allclose(again.box, shots[0].box)


@pytest.mark.parametrize("seed", range(8))
def test_in_another_span_greys_below_it_are_black_and_others_on_a_line(
    seed: int, shots: list[ThermalImage]
) -> None:
    before, after = shots[seed], change_span(shots[seed], np.random.default_rng(seed))
    assert after.box is before.box
    assert after.is_good is before.is_good
    order = np.argsort(before.grey.ravel(), kind="stable")
    greys, others = before.grey.ravel()[order].astype(float), after.grey.ravel()[order].astype(float)
    assert (np.diff(others) >= 0.0).all()
    assert (before.grey[after.grey == 0].max(initial=0) <= before.grey[after.grey > 0]).all()
    is_inside = (others > 0.0) & (others < 255.0)
    if len(set(greys[is_inside])) > 2:
        gain, offset = np.polyfit(greys[is_inside], others[is_inside], 1)
        assert np.abs(gain * greys[is_inside] + offset - others[is_inside]).max() < 1.5


@pytest.mark.parametrize("seed", range(8))
def test_what_was_and_is_below_the_span_does_not_change(seed: int, shots: list[ThermalImage]) -> None:
    before, after = shots[seed], change_span(shots[seed], np.random.default_rng(seed))
    coldest = before.grey[after.grey == 0].max(initial=0) - 2.0  # a gain of 0.6 makes a grey of 1.6 black
    was_black = before.grey.astype(float) + before.change <= coldest
    assert not after.change[was_black].any()
    assert after.change[~was_black].any()


def test_spans_go_from_all_of_the_image_to_hardly_any(shots: list[ThermalImage]) -> None:
    rng = np.random.default_rng(0)
    black = [float((change_span(shots[0], rng).grey == 0).mean()) for _ in range(100)]
    assert min(black) < 0.1
    assert 0.85 < max(black) < 1.0


@pytest.mark.parametrize("seed", range(4))
def test_a_faint_shot_has_less_contrast_and_nothing_is_clipped(seed: int, shots: list[ThermalImage]) -> None:
    before, after = shots[seed], augmentation._fade(shots[seed], np.random.default_rng(seed))
    gain, offset = np.polyfit(before.grey.ravel().astype(float), after.grey.ravel().astype(float), 1)
    assert 0.09 < gain < 0.61
    assert np.abs(gain * before.grey + offset - after.grey).max() < 1.0
    assert np.abs(gain * before.change - after.change).max() < 1.5


@pytest.mark.parametrize("seed", range(6))
def test_a_poorer_camera_sees_the_same_people_less_sharply(seed: int, shots: list[ThermalImage]) -> None:
    before = replace(shots[seed], grey=np.kron([[0, 255] * 8] * 12, np.ones((10, 10))).astype(np.uint8))
    after = soften(before, np.random.default_rng(seed))
    assert after.grey.shape == before.grey.shape
    assert after.box is before.box
    # Where two greys meet they come nearer to each other; far from there they differ by noise alone.
    beside, within = (abs(after.grey[:, k::20].astype(int) - before.grey[:, k::20]).mean() for k in (9, 5))
    assert beside > within + 2.0
    assert np.abs(after.grey[5::10, 5::10].astype(int) - before.grey[5::10, 5::10]).max() < 30


@pytest.mark.parametrize("seed", range(12))
def test_who_is_cut_off_keeps_most_of_their_height_and_their_place(
    seed: int, shots: list[ThermalImage]
) -> None:
    before, after = shots[seed], crop(shots[seed], np.random.default_rng(seed))
    rows = len(after.grey)
    first = next(
        k for k in range(len(before.grey) - rows + 1) if np.array_equal(before.grey[k : k + rows], after.grey)
    )
    np.testing.assert_array_equal(after.change, before.change[first : first + rows])
    np.testing.assert_allclose(after.box, before.box - np.array([0.0, first, 0.0, 0.0]))
    assert after.mount.horizon_px == before.mount.horizon_px - first
    top, tall = after.box[0, 1], after.box[0, 3]
    shown = min(top + tall, rows) - max(top, 0.0)
    assert after.is_good[0] == (shown >= 0.6 * tall and top >= -0.25 * tall)
    assert shown > 0.55 * tall


def test_people_are_cut_off_at_feet_and_head(shots: list[ThermalImage]) -> None:
    rng = np.random.default_rng(0)
    cut = [crop(shots[k % 8], rng) for k in range(80)]
    assert sum(bool(one.box[0, 1] < -1.0) for one in cut) > 8
    assert sum(bool(one.box[0, 1] + one.box[0, 3] > len(one.grey) + 1.0) for one in cut) > 10


def test_who_is_cut_away_is_not_there(shots: list[ThermalImage]) -> None:
    low = np.array([[10.0, 105.0, 6.0, 14.0]])
    good = np.array([True, False])
    box = np.concatenate([shots[0].box, low])
    two = replace(
        shots[0],
        box=box,
        whole=box,
        is_good=good,
        is_clear=good,
        posture=np.zeros(2, np.int64),
        visible=np.ones(2),
    )
    part = take_rows(two, 0.0, 100.0, 60)
    np.testing.assert_array_equal(part.box, shots[0].box)
    assert len(part.is_good) == 1
    assert take_rows(two, 0.0, 30.0, 60) is two  # of too few rows nothing can be learned


def test_examples_vary(shots: list[ThermalImage]) -> None:
    rng = np.random.default_rng(0)
    varied = [augment(shots[0], rng) for _ in range(200)]
    sides = {True: mirror(shots[0]), False: shots[0]}
    is_mirrored = [bool(one.box[0, 0] == sides[True].box[0, 0]) for one in varied]
    is_as_it_was = [
        np.array_equal(one.grey, sides[side].grey) for one, side in zip(varied, is_mirrored, strict=True)
    ]
    is_cut = [len(one.grey) < len(shots[0].grey) for one in varied]
    assert 70 < sum(is_mirrored) < 130
    assert 3 < sum(is_as_it_was) < 60
    assert 30 < sum(is_cut) < 80


HIGH, WIDE = 100, 80


def shot_of(box: tuple[float, float, float, float], shots: list[ThermalImage]) -> ThermalImage:
    flat = np.full((HIGH, WIDE), 90, np.uint8)
    sure = np.ones(1, np.bool_)
    return replace(
        shots[0],
        grey=flat,
        change=flat,
        box=np.array([box]),
        whole=np.array([box]),
        is_good=sure,
        is_clear=sure,
    )


@pytest.mark.parametrize(
    ("box", "is_cut"),
    [
        ((20.0, 5.0, 20.0, 90.0), False),  # whole
        ((20.0, -10.0, 20.0, 90.0), False),  # hardly cut off
        ((20.0, -30.0, 20.0, 100.0), True),  # legs and chest
        ((20.0, 60.0, 20.0, 80.0), True),  # face and chest
        ((20.0, -40.0, 20.0, 170.0), True),  # neither head nor feet
        ((20.0, -70.0, 20.0, 100.0), False),  # shoes and shanks
        ((20.0, 80.0, 20.0, 80.0), False),  # a face
        ((72.0, 60.0, 20.0, 80.0), False),  # an arm
    ],
)
def test_who_is_cut_off_is_somebody_of_whom_a_third_is_left(
    box: tuple[float, float, float, float], is_cut: bool, shots: list[ThermalImage]
) -> None:
    shot = shot_of(box, shots)
    assert augmentation.is_cut_off(shot).tolist() == [is_cut]
    assert not augmentation.is_cut_off(replace(shot, is_clear=np.zeros(1, np.bool_))).any()


def test_images_are_cut_so_that_somebody_is_to_be_learned_from(shots: list[ThermalImage]) -> None:
    whole = shot_of((20.0, 10.0, 20.0, 80.0), shots)
    cut = [augmentation.augment_for(whole, np.random.default_rng(seed), WindowKind.CUT) for seed in range(60)]
    assert all(one.is_good.tolist() == augmentation.is_cut_off(one).tolist() for one in cut)
    assert sum(bool(one.is_good.any()) for one in cut) > 20
    assert all(len(one.grey) < HIGH for one in cut if one.is_good.any())


def test_for_whole_windows_images_vary_as_they_do(shots: list[ThermalImage]) -> None:
    one = augmentation.augment_for(shots[0], np.random.default_rng(4), WindowKind.WHOLE)
    np.testing.assert_array_equal(one.grey, augmentation.augment(shots[0], np.random.default_rng(4)).grey)


def test_small_people_are_not_worth_cutting_off(shots: list[ThermalImage]) -> None:
    assert not augmentation.has_people(shot_of((20.0, 10.0, 12.0, 50.0), shots), WindowKind.CUT)
    assert augmentation.has_people(shot_of((20.0, 10.0, 12.0, 50.0), shots), WindowKind.WHOLE)


def drawn_shot(seed: int = 0) -> ThermalImage:
    rng = np.random.default_rng(seed)
    grey = cv2.GaussianBlur(rng.normal(80.0, 60.0, (48, 64)), (0, 0), 2.0) * 2.0 - 80.0
    return ThermalImage(
        grey=np.clip(grey, 0.0, 255.0).astype(np.uint8),
        change=rng.integers(0, 40, (48, 64)).astype(np.uint8),
        mount=Mount(20.0, 80.0, 1.2),
        box=np.array([[10.0, 5.0, 8.0, 30.0]]),
        is_good=np.ones(1, np.bool_),
        is_clear=np.ones(1, np.bool_),
        whole=np.array([[8.0, 5.0, 12.0, 30.0]]),
        posture=np.zeros(1, np.int64),
        visible=np.ones(1),
    )


def test_a_dimmed_person_differs_less_from_the_surroundings_which_stay() -> None:
    grey = np.full((120, 160), 100, np.uint8)
    grey[30:90, 70:90] = 200
    box = np.array([[70.0, 30.0, 20.0, 60.0]])
    image = replace(drawn_shot(), grey=grey, change=grey // 4, box=box, whole=box)
    for seed in range(20):
        dimmed = dim_people(image, np.random.default_rng(seed))
        inside, change = dimmed.grey[40:80, 75:85].astype(int), dimmed.change[40:80, 75:85]
        contrast = abs(float(inside.mean()) - 100.0)
        assert 19.0 <= contrast <= 100.0
        assert change.mean() == pytest.approx(contrast / 100.0 * 50.0, abs=1.0)
        np.testing.assert_array_equal(dimmed.grey[:15], 100)
        np.testing.assert_array_equal(dimmed.grey[:, :60], 100)


@given(seed=st.integers(0, 99))
def test_texture_is_no_stronger_than_its_limit_and_does_not_change(seed: int) -> None:
    image = replace(drawn_shot(), grey=np.full((120, 160), 128, np.uint8))
    image = replace(image, change=np.zeros_like(image.grey))
    textured = add_texture(image, np.random.default_rng(seed))
    assert textured.grey.std() <= 1.2 * augmentation._MOST_TEXTURE
    assert not textured.change.any()


@given(seed=st.integers(0, 99), share=st.floats(0.0, 1.0))
def test_equalising_keeps_the_order_of_greys(seed: int, share: float) -> None:
    before = drawn_shot(seed)
    after = equalise(before, share)
    order = np.argsort(before.grey, axis=None)
    assert (np.diff(after.grey.ravel()[order].astype(int)) >= 0).all()


def test_equalised_greys_are_all_as_frequent_and_what_changes_follows() -> None:
    before = drawn_shot()
    after = equalise(before, 1.0)
    assert np.quantile(after.grey, [0.25, 0.5, 0.75]) == pytest.approx([64, 128, 191], abs=12)
    narrow = replace(before, grey=(100 + before.grey // 8).astype(np.uint8))
    assert equalise(narrow, 1.0).change.mean() > 3.0 * narrow.change.mean()
    unchanged = equalise(before, 0.0)
    np.testing.assert_array_equal(unchanged.grey, before.grey)
    np.testing.assert_array_equal(unchanged.change, before.change)


def test_sharpening_leaves_rims_at_edges_alone() -> None:
    step = np.full((20, 40), 80, np.uint8)
    step[:, 20:] = 160
    after = sharpen(step, 1.5, 1.0)
    assert after[10, 19] < 80
    assert after[10, 20] > 160
    np.testing.assert_array_equal(after[:, [2, 37]], step[:, [2, 37]])


def test_people_stay_where_they_are() -> None:
    rng = np.random.default_rng(0)
    shot = drawn_shot()
    came = [simulate_electronics(shot, rng) for _ in range(40)]
    assert all(one.box is shot.box and one.grey.shape == shot.grey.shape for one in came)
    assert 4 < sum(np.array_equal(one.grey, shot.grey) for one in came) < 30


def test_things_in_front_hide_people_and_what_changes_behind_them(shots: list[ThermalImage]) -> None:
    shot, rng = shots[0], np.random.default_rng(0)
    mask = np.zeros(shot.grey.shape, np.float32)
    left, top, width, height = shot.whole[0].astype(int).tolist()
    mask[top : top + height // 2, max(left - 9, 0) : left + width + 9] = 1.0
    hidden = put_in_front(shot, mask, rng)
    assert hidden.visible[0] / shot.visible[0] == pytest.approx(0.5, abs=0.05)
    assert not hidden.change[top + 5 : top + height // 2 - 5, left : left + width].any()
    away = np.s_[min(top + height // 2 + 6, len(shot.grey)) :]
    np.testing.assert_array_equal(hidden.grey[away], shot.grey[away])
    unhidden = put_in_front(shot, np.zeros_like(mask), rng)
    np.testing.assert_array_equal(unhidden.grey, shot.grey)
    np.testing.assert_array_equal(unhidden.visible, shot.visible)


def test_sun_and_shade_are_patches_and_do_not_move_boxes(shots: list[ThermalImage]) -> None:
    lit = [add_light(shot, np.random.default_rng(seed)) for seed, shot in enumerate(shots[:8])]
    assert all(np.any(one.grey != shot.grey) for one, shot in zip(lit, shots, strict=False))
    assert all(one.box is shot.box for one, shot in zip(lit, shots, strict=False))


def test_figures_and_borders_are_black_or_white_and_the_rest_is_unchanged(shots: list[ThermalImage]) -> None:
    for seed, shot in enumerate(shots[:12]):
        written = inscribe(shot, np.random.default_rng(seed)).grey
        assert set(np.unique(written[written != shot.grey])) <= {0, 255}
        fitted = blacken_borders(shot, np.random.default_rng(seed))
        cut = fitted.grey != shot.grey
        assert not fitted.grey[cut].any()
        inner = np.s_[40:-40, 50:-50]
        np.testing.assert_array_equal(fitted.grey[inner], shot.grey[inner])
