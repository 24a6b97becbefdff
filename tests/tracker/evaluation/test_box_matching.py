from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.box_matching import GATE, associate, pair_up
from tests.helpers.images.random_sequences import sequences, tracks_of, truth_of


def best_sum(overlap: np.ndarray, gate: float) -> float:
    """Try every one-to-one assignment."""
    if overlap.shape[0] > overlap.shape[1]:
        overlap = overlap.T
    gated = np.where(overlap > gate, overlap, 0.0)
    rows = np.arange(len(gated))
    return max(gated[rows, list(columns)].sum() for columns in permutations(range(gated.shape[1]), len(rows)))


@given(sequences(), st.sampled_from([0.0, 0.3, GATE]))
def test_the_sum_of_overlaps_in_each_frame_is_the_best_of_all_permutations(sequence, gate):
    truth, tracks = sequence
    pairs = pair_up(truth, tracks)
    chosen = associate(pairs, gate)
    for frame in np.unique(truth.frame):
        targets, candidates = truth.box[truth.frame == frame], tracks.box[tracks.frame == frame]
        overlap = iou(targets[:, None], candidates[None])
        here = chosen[truth.frame[pairs.target[chosen]] == frame]
        assert pairs.iou[here].sum() == pytest.approx(best_sum(overlap, gate), abs=1e-12)


@given(sequences())
def test_matches_are_one_to_one_within_a_frame_and_above_the_gate(sequence):
    truth, tracks = sequence
    pairs = pair_up(truth, tracks)
    chosen = associate(pairs)
    target, candidate = pairs.target[chosen], pairs.candidate[chosen]
    assert len(np.unique(target)) == len(target)
    assert len(np.unique(candidate)) == len(candidate)
    assert np.array_equal(truth.frame[target], tracks.frame[candidate])
    assert np.all(iou(truth.box[target], tracks.box[candidate]) > GATE)


@given(sequences())
def test_every_target_is_paired_with_every_candidate_of_its_frame(sequence):
    truth, tracks = sequence
    pairs = pair_up(truth, tracks)
    expected = [(i, j) for i, f in enumerate(truth.frame) for j, g in enumerate(tracks.frame) if f == g]
    assert list(zip(pairs.target, pairs.candidate, strict=True)) == expected


def test_an_overlap_of_exactly_one_half_is_not_enough():
    pairs = pair_up(truth_of([(1, 1, 0, 0, 10, 10)]), tracks_of([(1, 1, 0, 0, 10, 5)]))
    assert pairs.iou.tolist() == [0.5]
    assert len(associate(pairs)) == 0


def test_the_best_sum_wins_over_the_best_single_pair():
    truth = truth_of([(1, 1, 0, 0, 100, 10), (1, 2, 20, 0, 100, 10)])
    tracks = tracks_of([(1, 1, 15, 0, 100, 10), (1, 2, 37, 0, 100, 10)])
    pairs = pair_up(truth, tracks)
    chosen = associate(pairs)
    # Person 2 fits track 1 best, but then nobody is near enough to track 2.
    assert list(zip(pairs.target[chosen], pairs.candidate[chosen], strict=True)) == [(0, 0), (1, 1)]
