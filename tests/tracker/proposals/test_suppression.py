import numpy as np

from peopleboy.tracker.proposals.suppression import Proposals, suppress


def test_of_boxes_alike_the_surest_is_kept_as_the_mean_of_all() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [12.0, 10.0, 20.0, 50.0], [100.0, 10.0, 20.0, 50.0]])
    found = suppress(Proposals.of_trees(box, np.array([1.0, 1.0, 3.0])))
    np.testing.assert_allclose(found.box, [[100.0, 10.0, 20.0, 50.0], [11.0, 10.0, 20.0, 50.0]])
    np.testing.assert_allclose(found.score, [3.0, 1.0])


def test_a_box_weighs_as_much_as_its_score_is_sure() -> None:
    box = np.array([[10.0, 0.0, 20.0, 50.0], [14.0, 0.0, 20.0, 50.0]])
    found = suppress(Proposals.of_trees(box, np.log([3.0, 1.0])))
    np.testing.assert_allclose(found.box, [[11.0, 0.0, 20.0, 50.0]])


def test_a_part_of_a_person_is_nobody_else_and_does_not_move_them() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [12.0, 12.0, 10.0, 24.0]])
    found = suppress(Proposals.of_trees(box, np.array([2.0, 1.0])))
    np.testing.assert_allclose(found.box, box[:1])


def test_those_side_by_side_are_two() -> None:
    box = np.array([[10.0, 10.0, 20.0, 50.0], [22.0, 10.0, 20.0, 50.0]])
    assert len(suppress(Proposals.of_trees(box, np.array([2.0, 1.0]))).score) == 2


def test_between_two_who_are_surer_nobody_is_seen_in_their_arms() -> None:
    abreast = np.array([[10.0, 10.0, 20.0, 50.0], [33.0, 10.0, 20.0, 50.0]])
    between = np.array([[21.0, 10.0, 20.0, 50.0]])  # of whom 9 px are of the left one, 8 px of the right one
    box = np.concatenate([abreast, between])
    np.testing.assert_allclose(suppress(Proposals.of_trees(box, np.array([4.0, 3.0, 1.0]))).box, abreast)
    assert (
        len(suppress(Proposals.of_trees(box, np.array([4.0, 2.0, 3.0]))).box) == 3
    )  # is surer than one of them
    assert (
        len(suppress(Proposals.of_trees(box[[0, 2]], np.array([4.0, 1.0]))).box) == 2
    )  # hidden by one, seen beside


def test_nothing_stays_nothing() -> None:
    found = suppress(Proposals.of_trees(np.empty((0, 4)), np.empty(0)))
    assert found.box.shape == (0, 4)
    assert found.score.shape == (0,)
