import numpy as np
import pytest
from hypothesis import given

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.association import associate, pair_up
from peopleboy.tracker.evaluation.uncounted import ignore_uncounted, settle_uncounted
from tests.helpers.images.random_sequences import sequences, tracks_of, truth_of

NEAR, FAR = (1, 1, 0, 0, 40, 100), (1, 2, 200, 0, 20, 50)


def test_a_candidate_on_an_uncounted_person_is_taken_out():
    judged = ignore_uncounted(truth_of([NEAR, FAR], [True, False]), tracks_of([NEAR, FAR]))
    assert judged.truth.id.tolist() == judged.tracks.id.tolist() == [1]
    assert judged.ignored.id.tolist() == [2]


def test_a_second_candidate_on_one_uncounted_person_stays_a_false_alarm():
    twice = tracks_of([(1, 1, 200, 0, 20, 50), (1, 2, 201, 0, 20, 50)])
    judged = ignore_uncounted(truth_of([FAR], False), twice)
    assert judged.tracks.id.tolist() == [2]
    assert judged.ignored.id.tolist() == [1]


def test_a_candidate_that_hardly_overlaps_an_uncounted_person_stays():
    judged = ignore_uncounted(truth_of([FAR], False), tracks_of([(1, 1, 200, 0, 20, 25)]))
    assert len(judged.ignored) == 0


def test_a_counted_person_chooses_before_a_nearer_uncounted_one():
    truth = truth_of([(1, 1, 0, 0, 100, 10), (1, 2, 20, 0, 100, 10)], [True, False])
    judged = ignore_uncounted(truth, tracks_of([(1, 7, 18, 0, 100, 10)]))
    assert judged.tracks.id.tolist() == [7]
    assert len(judged.ignored) == 0


def test_absent_leaves_candidates_on_uncounted_people_in():
    judged = settle_uncounted(truth_of([FAR], False), tracks_of([FAR]), rule="absent")
    assert (len(judged.truth), len(judged.tracks), len(judged.ignored)) == (0, 1, 0)


@pytest.mark.parametrize(
    ("visible", "min_visible", "targets"), [(0.0, 0.0, 0), (0.01, 0.0, 1), (0.3, 0.3, 0), (0.31, 0.3, 1)]
)
def test_people_count_only_if_more_of_them_is_visible_than_the_least(visible, min_visible, targets):
    truth = truth_of([NEAR], visible=visible)
    judged = settle_uncounted(truth, tracks_of([NEAR]), min_visible=min_visible)
    assert len(judged.truth) == targets
    assert len(judged.ignored) == 1 - targets


@given(sequences())
def test_ignoring_loses_no_match_and_no_candidate(sequence):
    truth, tracks = sequence
    judged = ignore_uncounted(truth, tracks)
    before = pair_up(truth.take(truth.counted), tracks)
    after = pair_up(judged.truth, judged.tracks)
    assert judged.truth.counted.all()
    assert len(judged.tracks) + len(judged.ignored) == len(tracks)
    assert np.array_equal(before.iou[associate(before)], after.iou[associate(after)])


@pytest.mark.parametrize("bad", [{"rule": "drop"}, {"min_visible": -0.1}, {"min_visible": float("nan")}])
def test_an_unknown_rule_or_an_impossible_fraction_is_refused(bad):
    with pytest.raises(BadInput, match="must be"):
        settle_uncounted(truth_of([NEAR]), tracks_of([NEAR]), **bad)
