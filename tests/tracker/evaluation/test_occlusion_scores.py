from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.truth import events
from peopleboy.tracker.evaluation import occlusion_scores
from peopleboy.tracker.evaluation.occlusion_scores import (
    OccludedShares,
    Occlusion,
    by_length,
    find_occlusions,
    score_occlusions,
)
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes

BOX = (100.0, 50.0, 30.0, 90.0)
RATE_HZ = 10.0


def test_a_total_occlusion_is_the_event_logs() -> None:
    assert occlusion_scores.TOTAL_STARTS == events.TOTAL_STARTS
    assert occlusion_scores.TOTAL_ENDS == events.TOTAL_ENDS


def scene(hidden: list[float], track_ids: list[int | None]) -> list[Occlusion]:
    frames = np.arange(1, len(hidden) + 1)
    truth = TrueBoxes(
        frame=frames,
        id=np.ones(len(frames)),
        box=np.tile(BOX, (len(frames), 1)),
        counted=np.ones(len(frames), dtype=np.bool_),
        visible=1.0 - np.array(hidden),
    )
    seen = [(frame, track) for frame, track in zip(frames, track_ids, strict=True) if track is not None]
    tracks = TrackBoxes(
        frame=np.array([frame for frame, _ in seen], dtype=np.int64),
        id=np.array([track for _, track in seen], dtype=np.int64),
        box=np.tile(BOX, (len(seen), 1)),
        confidence=np.ones(len(seen)),
    )
    return score_occlusions(truth, tracks, OccludedShares(np.array(hidden), RATE_HZ))


def test_an_id_that_comes_back_is_kept_and_its_time_is_measured_from_the_end_of_the_occlusion() -> None:
    hidden = [0.0] * 10 + [1.0] * 5 + [0.4] * 10
    ids: list[int | None] = [7] * 10 + [None] * 8 + [7] * 7
    (occlusion,) = scene(hidden, ids)
    assert (occlusion.id_before, occlusion.id_after, occlusion.is_kept) == (7, 7, True)
    assert occlusion.duration_s == pytest.approx(0.5)
    assert occlusion.found_after_s == pytest.approx(0.3)


def test_nobody_hidden_is_nothing_to_score() -> None:
    assert scene([0.0] * 10, [7] * 10) == []


@pytest.mark.parametrize("after", [[None] * 10, [8] * 10])
def test_another_id_or_none_is_not_kept(after: list[int | None]) -> None:
    (occlusion,) = scene([0.0] * 10 + [1.0] * 5 + [0.0] * 10, [7] * 10 + [None] * 5 + after)
    assert not occlusion.is_kept
    assert math.isnan(occlusion.found_after_s) == (after[0] is None)


def test_an_id_that_flits_by_does_not_count_as_the_one_after() -> None:
    (occlusion,) = scene([0.0] * 10 + [1.0] * 5 + [0.0] * 20, [7] * 10 + [None] * 5 + [9] * 2 + [7] * 18)
    assert occlusion.is_kept
    assert occlusion.found_after_s == pytest.approx(0.2)


def test_a_second_occlusion_ends_the_time_after_the_first() -> None:
    hidden = [0.0] * 10 + [1.0] * 5 + [0.0] * 12 + [1.0] * 5 + [0.0] * 10
    ids: list[int | None] = [7] * 10 + [None] * 17 + [None] * 5 + [7] * 10
    first, second = scene(hidden, ids)
    assert first.id_after is None
    assert second.id_before is None


def test_who_only_peeps_out_between_two_occlusions_had_one_and_what_is_peeped_does_not_count_as_hidden() -> (
    None
):
    hidden = [0.0] * 10 + [1.0] * 5 + [0.7] * 3 + [1.0] * 4 + [0.2] * 10
    (occlusion,) = scene(hidden, [7] * 10 + [None] * 12 + [7] * 10)
    assert occlusion.is_kept
    assert (occlusion.start_frame, occlusion.end_frame) == (11, 23)
    assert occlusion.duration_s == pytest.approx(0.9)
    assert occlusion.found_after_s == 0.0


def test_who_leaves_the_image_while_hidden_or_never_comes_back_is_left_out() -> None:
    frame = np.array([1, 2, 3, 7, 8])
    assert find_occlusions(frame, np.array([0.0, 1.0, 1.0, 0.0, 1.0])) == []


@given(st.lists(st.floats(0.0, 1.0), max_size=60))
def test_occlusions_are_apart_and_begin_and_end_as_they_say(hidden: list[float]) -> None:
    frame = np.arange(1, len(hidden) + 1)
    spans = find_occlusions(frame, np.array(hidden))
    for start, end in spans:
        assert hidden[start - 1] > 0.98
        assert hidden[end - 1] < 0.5
        assert all(share >= 0.5 for share in hidden[start - 1 : end - 1])
    assert all(end < start for (_, end), (start, _) in pairwise(spans))


def test_the_table_counts_each_tracked_occlusion_once_and_leaves_the_untracked_out() -> None:
    kept = scene([0.0] * 10 + [1.0] * 5 + [0.0] * 10, [7] * 10 + [None] * 5 + [7] * 10)
    lost = scene([0.0] * 10 + [1.0] * 20 + [0.0] * 10, [7] * 10 + [None] * 30)
    untracked = scene([0.0] * 10 + [1.0] * 5 + [0.0] * 10, [None] * 25)
    table = by_length(kept + lost + untracked)
    assert sum(row.occlusions for row in table) == 2
    assert [(row.occlusions, row.kept, row.found) for row in table if row.occlusions] == [
        (1, 1, 1),
        (1, 0, 0),
    ]
    assert math.isnan(table[0].kept_share)
