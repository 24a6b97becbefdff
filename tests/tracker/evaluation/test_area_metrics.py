import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from peopleboy.tracker.evaluation.evaluate import evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from tests.helpers.images.random_sequences import as_tracks, sequences, tracks_of, truth_of

THESIS = ("cr", "cp", "ca", "ar", "ap", "aa")
PAPER = ("oc", "dc", "ocr", "ocp", "oca", "oar", "bap", "adc")

# Frame 1: person 1 is matched with IoU 0.8; person 2 is not, with IoU 40/160. Frame 2: person 1 is matched
# fully, and a ghost appears. Frame 3: nobody, but a ghost.
TRUTH = truth_of([(1, 1, 0, 0, 10, 10), (1, 2, 100, 0, 10, 10), (2, 1, 0, 0, 10, 10)])
TRACKS = tracks_of(
    [
        (1, 11, 0, 0, 10, 8),
        (1, 12, 100, 6, 10, 10),
        (2, 11, 0, 0, 10, 10),
        (2, 13, 50, 50, 10, 10),
        (3, 14, 50, 50, 10, 10),
    ]
)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("cr", 2 / 3),
        ("cp", 2 / 5),
        ("ca", 2 * 2 / (3 + 5)),
        ("ar", (0.8 + 0 + 1) / 3),
        ("ap", (1 + 0 + 1 + 0 + 0) / 5),
        ("aa", (4 * 2 * 80 / (200 + 180) + 3 * 2 * 100 / (100 + 200) + 1 * 0) / 8),
    ],
)
def test_thesis_metrics_match_those_worked_by_hand(name, value):
    assert getattr(evaluate(TRUTH, TRACKS).thesis, name) == pytest.approx(100 * value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("oc", (2 + 1) / (2 + 1)),
        ("dc", 1.0),
        ("ocr", (2 + 1 + 0) / 3),
        ("ocp", (2 + 1 + 0) / 5),
        ("oca", 2 * 3 / (3 + 5)),
        ("oar", (0.8 + 0.4 + 1) / 3),
        ("bap", (1 + 0.4 + 1 + 0 + 0) / 5),
        ("adc", (4 * 2 * 120 / (200 + 180) + 3 * 2 * 100 / (100 + 200) + 1 * 0) / 8),
    ],
)
def test_paper_metrics_match_those_worked_by_hand(name, value):
    assert getattr(evaluate(TRUTH, TRACKS).paper, name) == pytest.approx(100 * value)


def stand(frames: range, identity: int, left: float = 0.0) -> list:
    return [(frame, identity, left, 0, 10, 30) for frame in frames]


def test_a_late_and_lingering_track_has_the_overlap_and_dice_worked_by_hand():
    paper = evaluate(truth_of(stand(range(1, 11), 1)), tracks_of(stand(range(3, 15), 1))).paper
    assert paper.oc == pytest.approx(100 * 8 / 10)
    assert paper.dc == pytest.approx(100 * 2 * 8 / (10 + 12))


def test_a_scattered_track_counts_with_its_longest_piece():
    pieces = stand(range(1, 5), 1) + stand(range(5, 11), 2)
    paper = evaluate(truth_of(stand(range(1, 11), 1)), tracks_of(pieces)).paper
    assert paper.oc == pytest.approx(100 * 6 / 10)
    assert paper.dc == pytest.approx(100 * 2 * 6 / (10 + 6))


def test_ranges_of_people_in_different_places_are_not_paired():
    paper = evaluate(truth_of(stand(range(1, 11), 1)), tracks_of(stand(range(1, 11), 1, left=200))).paper
    assert paper.oc == paper.dc == 0.0


def test_a_surplus_in_one_frame_does_not_make_up_for_a_lack_in_another():
    truth = truth_of(stand(range(1, 3), 1))
    paper = evaluate(truth, tracks_of([(1, 1, 0, 0, 10, 30), (1, 2, 90, 0, 10, 30)])).paper
    assert (paper.ocr, paper.ocp) == (50.0, 50.0)


@given(sequences(all_counted=True))
def test_perfect_tracks_give_100_everywhere(sequence):
    truth, _ = sequence
    assume(len(truth) > 0)
    scores = evaluate(truth, as_tracks(truth))
    values = [getattr(scores.thesis, name) for name in THESIS] + [
        getattr(scores.paper, name) for name in PAPER
    ]
    assert values == pytest.approx([100.0] * len(values), abs=1e-9)


@given(sequences())
def test_metrics_lie_between_0_and_100_and_are_undefined_only_without_a_denominator(sequence):
    scores = evaluate(*sequence)
    for name in THESIS + PAPER:
        value = getattr(scores.thesis if name in THESIS else scores.paper, name)
        if math.isnan(value):
            assert scores.counts.targets == 0 or scores.counts.candidates == 0
        else:
            assert 0.0 <= value <= 100.0


@given(sequences(), st.integers(1, 5))
def test_adding_false_alarms_never_raises_precision_nor_changes_recall(sequence, ghosts):
    truth, tracks = sequence
    assume(len(tracks) > 0)
    number = np.arange(ghosts)
    away = np.stack([5000.0 + 100.0 * number, 0.0 * number, 0 * number + 10.0, 0 * number + 30.0], axis=1)
    haunted = TrackBoxes(
        frame=np.append(tracks.frame, number % 3 + 1),
        id=np.append(tracks.id, 900 + number),
        box=np.concatenate([tracks.box, away]),
        confidence=np.append(tracks.confidence, np.ones(ghosts)),
    )
    before, after = evaluate(truth, tracks), evaluate(truth, haunted)
    for name in ("cp", "ap", "ca"):
        if not math.isnan(getattr(before.thesis, name)):
            assert getattr(after.thesis, name) <= getattr(before.thesis, name) + 1e-9
    assert after.thesis.cr == pytest.approx(before.thesis.cr, nan_ok=True)
    assert after.thesis.ar == pytest.approx(before.thesis.ar, nan_ok=True)
    assert after.mot.clear.mota <= before.mot.clear.mota or math.isnan(before.mot.clear.mota)


@given(sequences(), st.integers(0, 2**32 - 1))
def test_shuffling_ids_within_each_frame_leaves_the_thesis_metrics(sequence, seed):
    truth, tracks = sequence
    rng = np.random.default_rng(seed)
    shuffled = tracks.id.copy()
    for frame in np.unique(tracks.frame):
        here = tracks.frame == frame
        shuffled[here] = rng.permutation(shuffled[here])
    renamed = TrackBoxes(frame=tracks.frame, id=shuffled, box=tracks.box, confidence=tracks.confidence)
    before, after = evaluate(truth, tracks).thesis, evaluate(truth, renamed).thesis
    for name in THESIS:
        assert getattr(after, name) == pytest.approx(getattr(before, name), nan_ok=True)


@pytest.mark.parametrize("name", [*THESIS, *PAPER])
def test_nobody_there_and_nobody_found_is_undefined(name):
    scores = evaluate(truth_of([]), tracks_of([]))
    assert math.isnan(getattr(scores.thesis if name in THESIS else scores.paper, name))
