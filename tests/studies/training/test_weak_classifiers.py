import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.studies.training.weak_classifiers import (
    SortedSums,
    best_stump,
    weighted_sums,
)


@pytest.mark.parametrize(
    ("features", "most", "count"), [(6, 1, 6), (3, 2, 243), (6, 2, 1206), (6, 3, 129206)]
)
def test_there_are_as_many_weighted_sums_as_in_the_thesis(features, most, count):
    assert weighted_sums(features, most).shape == (count, features)


def test_a_weighted_pair_has_one_weight_of_1_and_another_of_up_to_1_in_twentieths():
    pairs = weighted_sums(6, 2)[6:]
    assert np.all(np.count_nonzero(pairs, axis=1) == 2)
    assert np.all(np.abs(pairs).max(axis=1) == 1)
    small = np.abs(pairs[pairs != 0])
    assert small.min() == pytest.approx(0.05)
    assert np.allclose(small * 20, np.rint(small * 20))


def test_every_two_features_meet_with_either_sign_and_either_one_leading():
    pairs = weighted_sums(6, 2)[6:]
    for i in range(6):
        for j in range(i + 1, 6):
            both = pairs[(pairs[:, i] != 0) & (pairs[:, j] != 0)]
            assert len(both) == 80
            ratio = both[:, j] / both[:, i]
            assert (ratio > 0).sum() == (ratio < 0).sum() == 40
            assert (np.abs(ratio) < 1).sum() == (np.abs(ratio) > 1).sum() == 38


def weighted_error(examples, is_positive, example_weight, weights, stump):
    called = stump.parity * (examples @ weights[stump.row]) < stump.parity * stump.threshold
    return example_weight[called != is_positive].sum()


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 10_000))
def test_the_best_stump_has_the_smallest_weighted_error_of_all(seed):
    rng = np.random.default_rng(seed)
    examples = rng.integers(-3, 4, (12, 3)).astype(float)
    is_positive = rng.random(12) < 0.5
    example_weight = rng.random(12)
    weights = weighted_sums(3, 2)[::5]
    stump = best_stump(SortedSums.build(examples, weights), is_positive, example_weight)
    least = np.inf
    for row in weights:
        sums = examples @ row
        for threshold in np.unique(sums.round(6))[:-1] + 1e-3:
            wrong = example_weight[(sums < threshold) != is_positive].sum()
            least = min(least, wrong, example_weight.sum() - wrong)
    assert weighted_error(examples, is_positive, example_weight, weights, stump) == pytest.approx(least)
