import numpy as np
import pytest
from hypothesis import given
from trackeval.datasets import MotChallenge2DBox

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.box_matching import ignore_uncounted, settle_uncounted
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
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


def test_a_candidate_is_on_the_one_whom_it_overlaps_more_counted_or_not():
    truth = truth_of([(1, 1, 0, 0, 100, 10), (1, 2, 20, 0, 100, 10)], [True, False])
    judged = ignore_uncounted(truth, tracks_of([(1, 7, 18, 0, 100, 10)]))
    assert judged.ignored.id.tolist() == [7]
    judged = ignore_uncounted(truth, tracks_of([(1, 7, 2, 0, 100, 10)]))
    assert judged.tracks.id.tolist() == [7]
    both = ignore_uncounted(truth, tracks_of([(1, 7, 18, 0, 100, 10), (1, 8, 2, 0, 100, 10)]))
    assert (both.tracks.id.tolist(), both.ignored.id.tolist()) == ([8], [7])


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
def test_ignoring_takes_out_what_trackeval_takes_out_as_on_distractors(sequence):
    truth, tracks = sequence
    judged = ignore_uncounted(truth, tracks)
    assert judged.truth.counted.all()
    assert len(judged.tracks) + len(judged.ignored) == len(tracks)
    is_kept = np.zeros(len(tracks), dtype=np.bool_)
    is_kept[kept_by_trackeval(truth, tracks)] = True
    assert np.array_equal(judged.tracks.box, tracks.box[is_kept])
    assert np.array_equal(judged.ignored.box, tracks.box[~is_kept])


def kept_by_trackeval(truth: TrueBoxes, tracks: TrackBoxes) -> list[int]:
    """Let the package prepare a sequence, uncounted people as distractors, and tell which tracks stay."""
    data = MotChallenge2DBox.__new__(MotChallenge2DBox)  # its constructor wants files
    data.benchmark, data.do_preproc = "MOT17", True
    data.class_name_to_class_id = {
        "pedestrian": 1, "person_on_vehicle": 2, "static_person": 7, "distractor": 8, "reflection": 12
    }  # fmt: skip
    data.valid_class_numbers = list(data.class_name_to_class_id.values())
    frames = range(1, max(truth.last_frame, tracks.last_frame) + 1)
    there, here = ([np.flatnonzero(rows.frame == frame) for frame in frames] for rows in (truth, tracks))
    raw = {
        "num_timesteps": len(frames),
        "seq": "drawn",
        "gt_ids": [truth.id[rows] for rows in there],
        "gt_classes": [np.where(truth.counted[rows], 1, 8) for rows in there],
        "gt_extras": [{"zero_marked": truth.counted[rows]} for rows in there],
        "gt_dets": [truth.box[rows] for rows in there],
        "tracker_ids": [tracks.id[rows] for rows in here],
        "tracker_classes": [np.ones(len(rows), int) for rows in here],
        "tracker_confidences": here,  # which it hands through
        "tracker_dets": [tracks.box[rows] for rows in here],
        "similarity_scores": [
            data._calculate_similarities(truth.box[t], tracks.box[c])
            for t, c in zip(there, here, strict=True)
        ],
    }
    ready = data.get_preprocessed_seq_data(raw, "pedestrian")
    return [row for rows in ready["tracker_confidences"] for row in rows.tolist()]


@pytest.mark.parametrize("bad", [{"rule": "drop"}, {"min_visible": -0.1}, {"min_visible": float("nan")}])
def test_an_unknown_rule_or_an_impossible_fraction_is_refused(bad):
    with pytest.raises(BadInput, match=r"unknown uncounted|must be"):
        settle_uncounted(truth_of([NEAR]), tracks_of([NEAR]), **bad)
