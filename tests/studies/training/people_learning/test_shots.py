from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.people_learning.shots import PeopleShot, shots_of
from tests.helpers.images.drawn_films import drawn_film


def test_boxes_to_learn_from_are_those_of_the_film_as_wide_as_the_torso(shots: list[PeopleShot]) -> None:
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
    assert [shot.is_good.tolist() for shot in shots_of([tmp_path / "film.npz"])] == [[is_good]]


def test_of_whom_nothing_is_seen_nobody_is_told(tmp_path: Path) -> None:
    film = drawn_film(0, 1)
    film.shown_px[:] = 8.0
    film.save(tmp_path / "film.npz")
    assert len(next(shots_of([tmp_path / "film.npz"])).box) == 0


def test_a_shot_mirrored_twice_is_itself(shots: list[PeopleShot]) -> None:
    again = shots[0].mirrored().mirrored()
    np.testing.assert_array_equal(again.grey, shots[0].grey)
    np.testing.assert_array_equal(again.change, shots[0].change)
    np.testing.assert_allclose(again.box, shots[0].box)


@pytest.mark.parametrize("seed", range(8))
def test_in_another_span_greys_below_it_are_black_and_others_on_a_line(
    seed: int, shots: list[PeopleShot]
) -> None:
    before, after = shots[seed], shots[seed].spanned(np.random.default_rng(seed))
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
def test_what_was_and_is_below_the_span_does_not_change(seed: int, shots: list[PeopleShot]) -> None:
    before, after = shots[seed], shots[seed].spanned(np.random.default_rng(seed))
    coldest = before.grey[after.grey == 0].max(initial=0) - 2.0  # a gain of 0.6 makes a grey of 1.6 black
    was_black = before.grey.astype(float) + before.change <= coldest
    assert not after.change[was_black].any()
    assert after.change[~was_black].any()


def test_spans_go_from_all_of_the_image_to_hardly_any(shots: list[PeopleShot]) -> None:
    rng = np.random.default_rng(0)
    black = [float((shots[0].spanned(rng).grey == 0).mean()) for _ in range(100)]
    assert min(black) < 0.1
    assert 0.85 < max(black) < 1.0


def test_negated_twice_is_itself(shots: list[PeopleShot]) -> None:
    before, once = shots[0], shots[0].negated()
    assert (once.grey.astype(int) + before.grey == 255).all()
    np.testing.assert_array_equal(once.negated().grey, before.grey)
    assert once.change is before.change


@pytest.mark.parametrize("seed", range(4))
def test_a_faint_shot_has_less_contrast_and_nothing_is_clipped(seed: int, shots: list[PeopleShot]) -> None:
    before, after = shots[seed], shots[seed].faint(np.random.default_rng(seed))
    gain, offset = np.polyfit(before.grey.ravel().astype(float), after.grey.ravel().astype(float), 1)
    assert 0.09 < gain < 0.61
    assert np.abs(gain * before.grey + offset - after.grey).max() < 1.0
    assert np.abs(gain * before.change - after.change).max() < 1.5


@pytest.mark.parametrize("seed", range(6))
def test_a_poorer_camera_sees_the_same_people_less_sharply(seed: int, shots: list[PeopleShot]) -> None:
    before = replace(shots[seed], grey=np.kron([[0, 255] * 8] * 12, np.ones((10, 10))).astype(np.uint8))
    after = before.softened(np.random.default_rng(seed))
    assert after.grey.shape == before.grey.shape
    assert after.box is before.box
    # Where two greys meet they come nearer to each other; far from there they differ by noise alone.
    beside, within = (abs(after.grey[:, k::20].astype(int) - before.grey[:, k::20]).mean() for k in (9, 5))
    assert beside > within + 2.0
    assert np.abs(after.grey[5::10, 5::10].astype(int) - before.grey[5::10, 5::10]).max() < 30


@pytest.mark.parametrize("seed", range(12))
def test_who_is_cut_off_keeps_most_of_their_height_and_their_place(
    seed: int, shots: list[PeopleShot]
) -> None:
    before, after = shots[seed], shots[seed].cut_off(np.random.default_rng(seed))
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


def test_people_are_cut_off_at_feet_and_head(shots: list[PeopleShot]) -> None:
    rng = np.random.default_rng(0)
    cut = [shots[k % 8].cut_off(rng) for k in range(80)]
    assert sum(bool(one.box[0, 1] < -1.0) for one in cut) > 8
    assert sum(bool(one.box[0, 1] + one.box[0, 3] > len(one.grey) + 1.0) for one in cut) > 10


def test_who_is_cut_away_is_not_there(shots: list[PeopleShot]) -> None:
    low = np.array([[10.0, 105.0, 6.0, 14.0]])
    good = np.array([True, False])
    two = replace(shots[0], box=np.concatenate([shots[0].box, low]), is_good=good, is_clear=good)
    part = two.part(0.0, 100.0, 60)
    np.testing.assert_array_equal(part.box, shots[0].box)
    assert len(part.is_good) == 1
    assert two.part(0.0, 30.0, 60) is two  # of too few rows nothing can be learned


def test_examples_vary(shots: list[PeopleShot]) -> None:
    rng = np.random.default_rng(0)
    varied = [shots[0].varied(rng) for _ in range(200)]
    sides = {True: shots[0].mirrored(), False: shots[0]}
    is_mirrored = [bool(one.box[0, 0] == sides[True].box[0, 0]) for one in varied]
    is_as_it_was = [
        np.array_equal(one.grey, sides[side].grey) for one, side in zip(varied, is_mirrored, strict=True)
    ]
    is_cut = [len(one.grey) < len(shots[0].grey) for one in varied]
    assert 70 < sum(is_mirrored) < 130
    assert 30 < sum(is_as_it_was) < 90
    assert 30 < sum(is_cut) < 80
