import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from trackeval.datasets._base_dataset import _BaseDataset
from trackeval.metrics import CLEAR, HOTA, Identity

from peopleboy.tracker.evaluation.box_matching import pair_up
from peopleboy.tracker.evaluation.mot_metrics import MotMetrics, measure_mot
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from tests.helpers.images.random_sequences import as_tracks, sequences, tracks_of, truth_of

REFERENCES = (HOTA(), CLEAR({"PRINT_CONFIG": False}), Identity({"PRINT_CONFIG": False}))


def measure(truth: TrueBoxes, tracks: TrackBoxes) -> MotMetrics:
    return measure_mot(truth, tracks, pair_up(truth, tracks))


def trackeval_data(truth: TrueBoxes, tracks: TrackBoxes) -> dict:
    frames = range(1, max(truth.last_frame, tracks.last_frame) + 1)
    here = [(truth.frame == frame, tracks.frame == frame) for frame in frames]
    return {
        "num_timesteps": len(frames),
        "num_gt_dets": len(truth),
        "num_tracker_dets": len(tracks),
        "num_gt_ids": len(np.unique(truth.id)),
        "num_tracker_ids": len(np.unique(tracks.id)),
        "gt_ids": [np.unique(truth.id, return_inverse=True)[1][t] for t, _ in here],
        "tracker_ids": [np.unique(tracks.id, return_inverse=True)[1][c] for _, c in here],
        "similarity_scores": [
            _BaseDataset._calculate_box_ious(truth.box[t], tracks.box[c], box_format="xywh") for t, c in here
        ],
    }


def assert_equal(ours: MotMetrics, hota: dict, clear: dict, identity: dict) -> None:
    """Compare every figure; where ours is undefined (NaN), TrackEval says 0."""
    assert ours.clear.matches == clear["CLR_TP"]
    assert (ours.clear.misses, ours.clear.false_positives) == (clear["CLR_FN"], clear["CLR_FP"])
    assert ours.clear.switches == clear["IDSW"]
    assert (ours.clear.mostly_tracked, ours.clear.mostly_lost) == (clear["MT"], clear["ML"])
    assert ours.clear.fragments == clear["Frag"]
    assert ours.hota.matches.tolist() == np.asarray(hota["HOTA_TP"]).tolist()
    figures = {
        "mota": (ours.clear.mota, clear["MOTA"]),
        "motp": (ours.clear.motp, clear["MOTP"]),
        "idf1": (ours.identity.idf1, identity["IDF1"]),
        "idp": (ours.identity.idp, identity["IDP"]),
        "idr": (ours.identity.idr, identity["IDR"]),
        "hota": (ours.hota.hota, np.mean(hota["HOTA"])),
        "deta": (ours.hota.deta, np.mean(hota["DetA"])),
        "assa": (ours.hota.assa, np.mean(hota["AssA"])),
        "detre": (ours.hota.detre, np.mean(hota["DetRe"])),
        "detpr": (ours.hota.detpr, np.mean(hota["DetPr"])),
        "assre": (ours.hota.assre, np.mean(hota["AssRe"])),
        "asspr": (ours.hota.asspr, np.mean(hota["AssPr"])),
        "loca": (ours.hota.loca, np.mean(hota["LocA"])),
    }
    for name, (value, expected) in figures.items():
        of_nothing = 100.0 if name == "loca" else 0.0  # there, where we leave a metric undefined
        assert_allclose(np.nan_to_num(value, nan=of_nothing), 100.0 * expected, atol=1e-9, err_msg=name)


@given(sequences())
def test_every_figure_agrees_with_trackeval(sequence):
    data = trackeval_data(*sequence)
    assert_equal(measure(*sequence), *(metric.eval_sequence(data) for metric in REFERENCES))


@given(st.lists(sequences(), min_size=2, max_size=3))
def test_sums_over_sequences_agree_with_trackeval(many):
    many = [sequence for sequence in many if len(sequence[0]) and len(sequence[1])]
    assume(many)
    first, *others = [measure(*sequence) for sequence in many]
    combined = [
        metric.combine_sequences(
            {i: metric.eval_sequence(trackeval_data(*one)) for i, one in enumerate(many)}
        )
        for metric in REFERENCES
    ]
    assert_equal(sum(others, start=first), *combined)


@given(sequences())
def test_perfect_tracks_are_perfect(sequence):
    truth, _ = sequence
    assume(len(truth) > 0)
    mot = measure(truth, as_tracks(truth))
    figures = (mot.clear.mota, mot.clear.motp, mot.identity.idf1, mot.hota.hota, mot.hota.deta, mot.hota.assa)
    assert figures == pytest.approx((100.0,) * 6)


def test_a_swap_halfway_costs_two_switches_and_half_the_identity():
    left, right = (0, 0, 10, 30), (50, 0, 10, 30)
    truth = truth_of(
        [(frame, person, *box) for frame in range(1, 11) for person, box in ((1, left), (2, right))]
    )
    swapped = tracks_of(
        [(f, i if f <= 5 else 3 - i, *box) for f in range(1, 11) for i, box in ((1, left), (2, right))]
    )
    mot = measure(truth, swapped)
    assert mot.clear.switches == 2
    assert mot.clear.mota == pytest.approx(100 * (1 - 2 / 20))
    assert mot.identity.idf1 == pytest.approx(50.0)
    # Each of the four combinations is matched in 5 of the 15 frames that person and track have in all.
    assert mot.hota.deta == pytest.approx(100.0)
    assert mot.hota.assa == pytest.approx(100 * 5 / 15)
    assert mot.hota.hota == pytest.approx(100 * math.sqrt(1 / 3))


def test_mota_is_negative_if_there_are_more_errors_than_people():
    ghosts = tracks_of([(1, 1, 90, 0, 10, 30), (1, 2, 200, 0, 10, 30)])
    assert measure(truth_of([(1, 1, 0, 0, 10, 30)]), ghosts).clear.mota == pytest.approx(-200.0)


def test_nobody_there_and_nobody_found_is_undefined():
    mot = measure(truth_of([]), tracks_of([]))
    assert all(
        math.isnan(value) for value in (mot.clear.mota, mot.identity.idf1, mot.hota.hota, mot.hota.assa)
    )
