"""OSPA and OSPA(2) against their definitions, by brute force over all assignments."""

import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.box_matching import pair_up
from peopleboy.tracker.evaluation.ospa import SetDistances, measure_sets
from peopleboy.tracker.evaluation.sequence import Rows, TrackBoxes, TrueBoxes
from tests.helpers.images.random_sequences import as_tracks, sequences, tracks_of, truth_of


def measure(truth: TrueBoxes, tracks: TrackBoxes) -> SetDistances:
    return measure_sets(truth, tracks, pair_up(truth, tracks))


def ospa(distance: np.ndarray) -> float:
    """Compute the OSPA distance of order 1 and cut-off 1 from the distances (M, N) of all pairs."""
    distance = distance if distance.shape[0] <= distance.shape[1] else distance.T
    few, many = distance.shape
    if many == 0:
        return 0.0
    assigned = (sum(distance[k, j] for k, j in enumerate(order)) for order in permutations(range(many), few))
    return (min(assigned) + many - few) / many


def distances(truth: list, tracks: list, apart) -> np.ndarray:
    return np.array([[apart(one, other) for other in tracks] for one in truth]).reshape(
        len(truth), len(tracks)
    )


def boxes_of(rows: Rows, frame: int) -> list[np.ndarray]:
    return list(rows.box[rows.frame == frame])


def paths_of(rows: Rows) -> list[dict[int, np.ndarray]]:
    return [
        dict(zip(rows.frame[rows.id == one].tolist(), rows.box[rows.id == one], strict=True))
        for one in np.unique(rows.id)
    ]


def apart(one: np.ndarray, other: np.ndarray) -> float:
    return 1.0 - float(iou(one, other))


def paths_apart(one: dict[int, np.ndarray], other: dict[int, np.ndarray]) -> float:
    frames = one.keys() | other.keys()
    return sum(apart(one[f], other[f]) if f in one and f in other else 1.0 for f in frames) / len(frames)


@given(sequences())
def test_both_distances_are_those_of_their_definitions(sequence):
    truth, tracks = sequence
    frames = np.union1d(truth.frame, tracks.frame)
    assume(len(frames) > 0)
    for frame in frames:
        assume(max(len(boxes_of(truth, frame)), len(boxes_of(tracks, frame))) <= 6)
    assume(max(len(np.unique(truth.id)), len(np.unique(tracks.id))) <= 6)
    sets = measure(truth, tracks)
    in_frames = [ospa(distances(boxes_of(truth, f), boxes_of(tracks, f), apart)) for f in frames]
    assert sets.ospa == pytest.approx(np.mean(in_frames))
    assert sets.ospa2 == pytest.approx(ospa(distances(paths_of(truth), paths_of(tracks), paths_apart)))


@given(sequences())
def test_equal_sets_are_0_apart_and_all_others_at_most_1(sequence):
    truth, tracks = sequence
    assume(len(truth) > 0)
    same = measure(truth, as_tracks(truth))
    assert (same.ospa, same.ospa2) == pytest.approx((0.0, 0.0))
    sets = measure(truth, tracks)
    assert 0.0 <= sets.ospa <= 1.0 + 1e-12
    assert 0.0 <= sets.ospa2 <= 1.0 + 1e-12


def test_a_swap_halfway_costs_nothing_in_a_frame_and_much_over_the_sequence():
    boxes = {1: (0, 0, 10, 30), 2: (50, 0, 10, 30)}
    truth = truth_of([(frame, who, *box) for frame in range(1, 11) for who, box in boxes.items()])
    swapped = tracks_of([(f, i if f <= 5 else 3 - i, *box) for f in range(1, 11) for i, box in boxes.items()])
    assert measure(truth, swapped).ospa == pytest.approx(0.0)
    assert measure(truth, swapped).ospa2 == pytest.approx(0.5)


@given(st.lists(sequences(), min_size=2, max_size=3))
def test_sums_over_sequences_weigh_frames_and_ids_alike(many):
    parts = [measure(*one) for one in many]
    first, *others = parts
    whole = sum(others, start=first)
    assume(whole.frames and whole.ids)
    assert whole.ospa == pytest.approx(sum(p.ospa * p.frames for p in parts if p.frames) / whole.frames)
    assert whole.ospa2 == pytest.approx(sum(p.ospa2 * p.ids for p in parts if p.ids) / whole.ids)


def test_no_person_and_no_track_is_undefined():
    sets = measure(truth_of([]), tracks_of([]))
    assert math.isnan(sets.ospa)
    assert math.isnan(sets.ospa2)
