import json
import math
import subprocess
import sys
from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.tracker.evaluation.evaluate import combine, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.evaluation.table import FIGURES, IF_KNOWN, NEED_EVERYBODY, rows, to_json
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import sequences, tracks_of, truth_of

PERSON, FAR = (0, 0, 20, 60), (100, 0, 8, 20)
TRUTH = truth_of([(1, 1, *PERSON), (2, 1, *PERSON), (1, 2, *FAR)], [True, True, False])
TRACKS = tracks_of([(1, 5, *PERSON), (2, 5, *PERSON), (1, 6, *FAR), (2, 7, 200, 0, 20, 60)])


def test_counts_match_those_worked_by_hand():
    counts = evaluate(TRUTH, TRACKS).counts
    assert (counts.frames, counts.targets, counts.candidates, counts.ignored) == (2, 2, 3, 1)
    assert (counts.matches, counts.misses, counts.false_alarms) == (2, 0, 1)
    assert (counts.tracks, counts.true_tracks, counts.false_tracks) == (3, 2, 1)


def test_taking_uncounted_people_for_absent_makes_boxes_on_them_false_alarms():
    ignore, absent = evaluate(TRUTH, TRACKS), evaluate(TRUTH, TRACKS, uncounted="absent")
    assert ignore.thesis.cp == pytest.approx(100 * 2 / 3)
    assert absent.thesis.cp == pytest.approx(100 * 2 / 4)
    assert absent.thesis.cr == ignore.thesis.cr == 100.0
    assert absent.counts.false_tracks == 2


def test_a_track_of_uncounted_people_only_is_not_a_false_track():
    scores = evaluate(truth_of([(1, 1, *FAR)], False), tracks_of([(1, 1, *FAR)]))
    assert (scores.counts.candidates, scores.counts.false_tracks) == (0, 0)


def test_candidates_after_the_last_person_are_false_alarms():
    scores = evaluate(truth_of([(1, 1, *PERSON)]), tracks_of([(1, 1, *PERSON), (9, 1, *PERSON)]))
    assert (scores.counts.frames, scores.counts.false_alarms) == (9, 1)


def test_the_length_of_the_sequence_is_taken_over_and_changes_nothing_else():
    told = evaluate(TRUTH, TRACKS, frames=50)
    assert told.counts.frames == 50
    assert to_json(told)["thesis"] == to_json(evaluate(TRUTH, TRACKS))["thesis"]


@pytest.mark.parametrize(
    ("truth_frame", "tracks_frame", "says"), [(3, 1, "truth: frame"), (1, 3, "tracks: frame")]
)
def test_rows_beyond_the_length_of_the_sequence_are_refused(truth_frame, tracks_frame, says):
    truth, tracks = truth_of([(truth_frame, 1, *PERSON)]), tracks_of([(tracks_frame, 1, *PERSON)])
    with refused(says, "2", "got 3"):
        evaluate(truth, tracks, frames=2)


def test_a_sequence_of_no_frames_holds_nobody_and_one_of_fewer_is_refused():
    nobody = truth_of([]), tracks_of([])
    assert evaluate(*nobody, frames=0).counts.frames == 0
    with refused("frames", "0 or more", "-1"):
        evaluate(*nobody, frames=-1)


def joined(many: list[tuple[TrueBoxes, TrackBoxes]]) -> tuple[TrueBoxes, TrackBoxes]:
    """Put sequences one after another, with names of their own."""

    def column(part: int, name: str, step: int = 0) -> np.ndarray:
        return np.concatenate([getattr(one[part], name) + step * i for i, one in enumerate(many)])

    shared = [
        {"frame": column(part, "frame", 100), "id": column(part, "id", 1000), "box": column(part, "box")}
        for part in (0, 1)
    ]
    counted = np.concatenate([truth.counted for truth, _ in many])
    truth = TrueBoxes(**shared[0], counted=counted, visible=column(0, "visible"))
    return truth, TrackBoxes(**shared[1], confidence=column(1, "confidence"))


@given(st.lists(sequences(), min_size=1, max_size=3))
def test_combined_scores_are_those_of_the_joined_sequences(many):
    combined = to_json(combine([evaluate(*one) for one in many]))
    whole = to_json(evaluate(*joined(many)))
    for group in ("thesis", "paper"):
        for name, value in whole[group].items():
            assert combined[group][name] == pytest.approx(value)
    for name in ("targets", "candidates", "ignored", "matches", "false_tracks"):
        assert combined["counts"][name] == whole["counts"][name]


def test_combining_nothing_is_refused():
    with pytest.raises(BadInput, match="at least one"):
        combine([])


@given(sequences())
def test_every_figure_is_printed_explained_and_fit_for_json(sequence):
    scores = evaluate(*sequence)
    printed = rows(scores)
    assert len({row.figure.name for row in printed}) == len(printed) == len(FIGURES)
    for row in printed:
        assert row.figure.unit in ("", "%", "m", "ms")
        assert row.figure.meaning.endswith(".")
        assert isinstance(row.value, int if row.figure.group == "counts" else float | int)
        assert math.isnan(row.value) or row.value <= 100.0 or row.figure.unit == ""
    stored = json.loads(json.dumps(to_json(scores), allow_nan=False))
    assert list(stored) == ["thesis", "paper", "mot", "sets", "counts"]
    assert {"HOTA_percent", "IDSW"} <= stored["mot"].keys()
    assert not [figure.key for figure in FIGURES if " " in figure.key or "%" in figure.key]
    assert [figure.key for figure in FIGURES if figure.unit == "m"] == [
        *("mean_error_m", "median_error_m", "p95_error_m")
    ]


@st.composite
def one_person_and_others(draw):
    """A person with boxes on and near it, by two ids, and boxes of a third somewhere else."""
    frames = draw(st.integers(1, 8))
    edges = st.integers(-8, 8)
    near = [
        (frame, draw(st.integers(1, 2)), draw(edges), draw(edges), 20, 60) for frame in range(1, frames + 1)
    ]
    elsewhere = [(frame, 3, 500 + draw(edges), 0, 20, 60) for frame in range(1, frames + 1)]
    return truth_of([(frame, 1, *PERSON) for frame in range(1, frames + 1)]), near, elsewhere


@given(one_person_and_others())
def test_boxes_on_others_change_nothing_that_is_told_of_a_person_who_alone_is_annotated(case):
    truth, near, elsewhere = case
    alone, among = (
        {row.figure.name: row.value for row in rows(evaluate(truth, tracks_of(boxes), is_single=True))}
        for boxes in (near, near + elsewhere)
    )
    for name in alone.keys() - {"candidates", "tracks"}:
        assert among[name] == pytest.approx(alone[name], nan_ok=True), name


def test_every_figure_that_is_not_told_of_one_person_would_have_changed_by_boxes_on_others():
    person, other = (1, 1, *PERSON), (1, 2, 500, 0, 20, 60)
    alone, among = (evaluate(truth_of([person]), tracks_of(boxes)) for boxes in ([person], [person, other]))
    in_image = [figure for figure in FIGURES if figure.group not in IF_KNOWN]
    changed = {figure.name for figure in in_image if figure.of(alone) != figure.of(among)}
    assert changed - {"candidates", "tracks"} == NEED_EVERYBODY - {"OCR"}
    lost = evaluate(truth_of([person]), tracks_of([other]))
    assert lost.paper.ocr == 100.0


def test_what_one_person_cannot_tell_is_null_and_stays_unknown_among_other_sequences():
    single = evaluate(TRUTH, TRACKS, is_single=True)
    for scores in (single, combine([single, evaluate(TRUTH, TRACKS)])):
        stored = {name: value for group in to_json(scores).values() for name, value in group.items()}
        assert {name for name, value in stored.items() if value is None} == {
            figure.key for figure in FIGURES if figure.name in NEED_EVERYBODY
        }
    assert single.counts.true_tracks == 2


@given(sequences())
def test_the_same_input_gives_the_same_scores(sequence):
    assert to_json(evaluate(*sequence)) == to_json(evaluate(*sequence))


@pytest.mark.slow
@given(sequences(), st.floats(-300.0, 300.0))
def test_rolling_an_image_all_round_changes_no_figure(sequence, columns):
    around = 200.0
    truth, tracks = sequence
    truth = replace(truth, around_px=around)

    def rolled(rows):
        box = rows.box.copy()
        box[:, 0] = (box[:, 0] + columns) % around
        return replace(rows, box=box)

    before, after = evaluate(truth, tracks), evaluate(rolled(truth), rolled(tracks))
    assert after.counts == before.counts
    assert_same_figures(after, before)
    # Nothing here is near the seam, so that it might as well not be there.
    assert_same_figures(before, evaluate(replace(truth, around_px=math.inf), tracks))


def assert_same_figures(one, other):
    for group, figures in to_json(one).items():
        for name, value in figures.items():
            assert value == pytest.approx(to_json(other)[group][name], abs=1e-6), f"{group}.{name}"


def test_scores_hold_plain_numbers():
    assert all(type(value) is int for value in asdict(evaluate(TRUTH, TRACKS).counts).values())


@pytest.mark.slow
def test_evaluation_needs_neither_simulator_nor_numba_nor_opencv():
    code = (
        "import sys, peopleboy.tracker.evaluation.table, peopleboy.tracker.evaluation.mot_files;"
        "print(sorted({'pybullet', 'numba', 'cv2', 'trackeval'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
