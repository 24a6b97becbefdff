import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from trackeval.datasets._base_dataset import _BaseDataset

from peopleboy.tracker.boxes import (
    add_edge_noise,
    area,
    corners,
    image_shares,
    intersection,
    iou,
    shared_of_smaller,
    within_image,
)


def random_boxes(seed: int, count: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform([-20, -20, 0, 0], [80, 80, 60, 60], (count, 4))


@pytest.mark.parametrize(
    ("other", "shared", "overlap"),
    [
        ((0, 0, 10, 10), 100, 1.0),
        ((5, 0, 10, 10), 50, 1 / 3),
        ((2, 2, 5, 5), 25, 0.25),
        ((10, 0, 10, 10), 0, 0.0),
        ((20, 20, 5, 5), 0, 0.0),
        ((5, 5, 0, 3), 0, 0.0),
        ((-5, -5, 10, 10), 25, 25 / 175),
    ],
)
def test_overlaps_match_those_worked_by_hand(other, shared, overlap):
    box, other = np.array([0.0, 0.0, 10.0, 10.0]), np.array(other, dtype=float)
    assert intersection(box, other) == shared
    assert iou(box, other) == pytest.approx(overlap)


def test_who_is_within_somebody_else_is_all_shared():
    box, others = np.array([0.0, 0.0, 10.0, 10.0]), np.array([[2.0, 2.0, 5, 5], [8, 0, 4, 5], [20, 0, 5, 5]])
    assert_allclose(shared_of_smaller(box, others), [1.0, 0.5, 0.0])
    assert_allclose(shared_of_smaller(others, box), [1.0, 0.5, 0.0])


@given(st.integers(0, 2**32 - 1))
def test_what_is_within_an_image_is_what_a_box_shares_with_it(seed):
    boxes, image = random_boxes(seed, 20), np.array([0.0, 0.0, 50.0, 40.0])
    cut = within_image(boxes, 50, 40)
    assert_allclose(area(cut), intersection(boxes, image), atol=1e-9)
    assert_allclose(intersection(cut, image), area(cut), atol=1e-9)


def test_two_boxes_without_area_do_not_overlap():
    nothing = np.array([[3.0, 3.0, 0.0, 0.0]])
    assert iou(nothing, nothing) == 0.0


@given(st.integers(0, 2**32 - 1), st.integers(0, 6), st.integers(0, 6))
def test_iou_agrees_with_trackeval(seed, rows, columns):
    a, b = random_boxes(seed, rows), random_boxes(seed + 1, columns)
    expected = _BaseDataset._calculate_box_ious(a, b, box_format="xywh")
    assert_allclose(iou(a[:, None], b[None]), expected, atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_iou_is_symmetric_within_0_and_1_and_1_only_for_a_box_with_itself(seed):
    a, b = random_boxes(seed, 20), random_boxes(seed + 1, 20)
    assert_allclose(iou(a, b), iou(b, a), atol=1e-15)
    assert np.all((iou(a, b) >= 0.0) & (iou(a, b) < 1.0))
    assert_allclose(iou(a, a), 1.0, atol=1e-12)


@given(st.integers(0, 2**32 - 1))
def test_the_shared_area_of_whole_pixel_boxes_is_the_number_of_shared_pixels(seed):
    a, b = np.floor(random_boxes(seed, 2) / 2.0)

    def pixels(box):
        left, top, width, height = box.astype(int)
        return {(u, v) for u in range(left, left + width) for v in range(top, top + height)}

    assert area(a) == len(pixels(a))
    assert intersection(a, b) == len(pixels(a) & pixels(b))


def test_boxes_of_an_image_all_round_are_the_same_on_either_side_of_its_seam():
    one, other = np.array([470.0, 5.0, 20.0, 40.0]), np.array([-10.0, 5.0, 20.0, 40.0])
    assert iou(one, other) == 0.0
    assert iou(one, other, around_px=480.0) == 1.0


@given(st.integers(0, 2**32 - 1), st.integers(60, 90))
def test_the_shared_area_all_round_is_the_number_of_shared_pixels(seed, around):
    many = np.floor(random_boxes(seed, 8))
    a, b = many[:4, None], many[None, 4:]

    def pixels(box):
        left, top, width, height = box.astype(int)
        return {(u % around, v) for u in range(left, left + width) for v in range(top, top + height)}

    shared = [[len(pixels(one) & pixels(other)) for other in b[0]] for one in a[:, 0]]
    assert_allclose(intersection(a, b, around), shared)


def test_corners_and_shares_of_the_image_are_those_of_the_box():
    box = (-0.5, 59.5, 320.0, 120.0)
    assert corners(box) == (-0.5, 59.5, 319.5, 179.5)
    assert image_shares(box, 320, 240) == (0.0, 0.5, 0.25, 0.75)
    assert image_shares((319.0, -0.5, 1.0, 240.0), 320, 240) == (1.0, 1.0, 0.0, 1.0)


def test_noise_moves_each_edge_independently_by_its_deviation() -> None:
    boxes = np.tile([100.0, 50.0, 40.0, 120.0], (40_000, 1))
    moved = add_edge_noise(boxes, 2.0, np.random.default_rng(0))
    left, top, width, height = (moved - boxes).T
    edges = np.stack([left, top, left + width, top + height])
    # The covariance of four independent edges; widths and heights vary by two edges.
    assert_allclose(np.cov(edges), 4.0 * np.eye(4), atol=0.1)
    assert_allclose(edges.mean(axis=1), 0.0, atol=0.04)
    assert_allclose([width.std(), height.std()], 2.0 * np.sqrt(2.0), atol=0.04)


def test_without_noise_boxes_stay_and_with_it_they_keep_an_area() -> None:
    boxes = random_boxes(0, 100)
    assert add_edge_noise(boxes, 0.0, np.random.default_rng(0)) is boxes
    moved, again = (add_edge_noise(boxes, 30.0, np.random.default_rng(1)) for _ in range(2))
    assert (moved == again).all()
    assert (moved[:, 2:] >= 1.0).all()
