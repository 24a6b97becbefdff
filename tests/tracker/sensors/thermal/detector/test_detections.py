import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.boxes import iou, shared_of_smaller
from peopleboy.tracker.sensors.detections import Detections, suppress


def one_by_one(found: Detections) -> Detections:
    """The best of boxes that share much, each the mean of those like it."""
    found = found.take(np.argsort(-found.score, kind="stable"))
    is_left, kept, means = np.ones(len(found.box), bool), [], []
    for k, (box, score) in enumerate(zip(found.box, found.score, strict=True)):
        if is_left[k]:
            alike = is_left & (iou(box, found.box) > 0.5)
            means.append(np.average(found.box, axis=0, weights=np.exp(found.score - score) * alike))
            kept.append(k)
            is_left &= shared_of_smaller(box, found.box) <= 0.65
    return found.take(np.array(kept, int))._replace(box=np.array(means).reshape(-1, 4))


def test_of_boxes_alike_the_surest_is_kept_as_the_mean_of_all() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [12.0, 10.0, 20.0, 50.0], [100.0, 10.0, 20.0, 50.0]])
    found = suppress(Detections.from_trees(box, np.array([1.0, 1.0, 3.0])))
    np.testing.assert_allclose(found.box, [[100.0, 10.0, 20.0, 50.0], [11.0, 10.0, 20.0, 50.0]])
    np.testing.assert_allclose(found.score, [3.0, 1.0])


def test_a_box_weighs_as_much_as_its_score_is_sure() -> None:
    box = np.array([[10.0, 0.0, 20.0, 50.0], [14.0, 0.0, 20.0, 50.0]])
    found = suppress(Detections.from_trees(box, np.log([3.0, 1.0])))
    np.testing.assert_allclose(found.box, [[11.0, 0.0, 20.0, 50.0]])


def test_a_part_of_a_person_is_nobody_else_and_does_not_move_them() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [12.0, 12.0, 10.0, 24.0]])
    found = suppress(Detections.from_trees(box, np.array([2.0, 1.0])))
    np.testing.assert_allclose(found.box, box[:1])


def test_those_side_by_side_are_two() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [22.0, 10.0, 20.0, 50.0]])
    assert len(suppress(Detections.from_trees(box, np.array([2.0, 1.0]))).score) == 2


def test_between_two_who_are_surer_nobody_is_seen_in_their_arms() -> None:
    abreast = np.array([[10.0, 10.0, 20.0, 50.0], [33.0, 10.0, 20.0, 50.0]])
    between = np.array([[21.0, 10.0, 20.0, 50.0]])  # of whom 9 px are of the left one, 8 px of the right one
    box = np.concatenate([abreast, between])
    np.testing.assert_allclose(suppress(Detections.from_trees(box, np.array([4.0, 3.0, 1.0]))).box, abreast)
    assert (
        len(suppress(Detections.from_trees(box, np.array([4.0, 2.0, 3.0]))).box) == 3
    )  # is surer than one of them
    assert (
        len(suppress(Detections.from_trees(box[[0, 2]], np.array([4.0, 1.0]))).box) == 2
    )  # hidden by one, seen beside


def test_nothing_stays_nothing() -> None:
    found = suppress(Detections.from_trees(np.empty((0, 4)), np.empty(0)))
    assert found.box.shape == (0, 4)
    assert found.score.shape == (0,)


@given(st.integers(0, 10_000), st.integers(0, 40))
def test_the_kernel_does_what_is_done_one_by_one(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    box = rng.uniform([0.0, 0.0, 10.0, 20.0], [300.0, 20.0, 30.0, 80.0], (count, 4))
    found = Detections.from_trees(box, rng.normal(0.0, 3.0, count))
    ours, theirs = suppress(found), one_by_one(found)
    is_kept = np.isin(theirs.score, ours.score)  # all but those between two others
    assert len(ours.score) == is_kept.sum()
    np.testing.assert_allclose(ours.box, theirs.box[is_kept], atol=1e-9)
