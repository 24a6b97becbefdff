from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import toy_runs as toy
from hypothesis import given
from hypothesis import strategies as st

from bad_input import BadInput
from scenarios.load import load_scenario
from scenarios.report.columns import are_same_scene, read_columns
from scenarios.report.errors import DISTANCES_M, curve, distance, found_share
from scenarios.report.figures import plain_lines
from scenarios.report.finished_run import read_finished
from scenarios.report.headline import Outcome, headline, headline_of_many, look_into
from scenarios.report.moments import worst_moments
from scenarios.report.pictures import Origin, show_frames
from scenarios.report.spans import between, settle, spans
from scenarios.report.story import Hold, Sight
from scenarios.run import RunOptions, run

CODES = st.lists(st.integers(0, 3), max_size=60).map(lambda values: np.array(values, np.int64))


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    root = tmp_path_factory.mktemp("runs")
    hidden = toy.hidden_from_40_to_60
    return {
        "steady": toy.write_run(root / "steady"),
        "swapped": toy.write_run(root / "swapped", toy.swapped, tracker="thesis"),
        "renumbered": toy.write_run(root / "renumbered", toy.renumbered, hidden, seed=1),
    }


def outcome(folder: Path) -> Outcome:
    return look_into(read_finished(folder))


@given(CODES)
def test_spans_put_together_are_the_column_and_neighbours_differ(values: np.ndarray) -> None:
    found = spans(values)
    assert [span.value for span in found for _ in range(span.length)] == values.tolist()
    assert all(a.value != b.value for a, b in pairwise(found))


@given(CODES, st.integers(1, 8))
def test_what_has_settled_lasts_and_settles_to_itself(values: np.ndarray, shortest: int) -> None:
    settled = settle(values, shortest)
    assert all(span.length >= shortest for span in spans(settled) if span.value)
    assert np.array_equal(settle(settled, 1), settled)


def test_a_short_break_is_bridged_and_a_fleeting_number_forgotten() -> None:
    values = np.array([1] * 10 + [0] * 2 + [1] * 10 + [2] * 2 + [0] * 10)
    assert settle(values, 4).tolist() == [1] * 22 + [0] * 12


def test_hysteresis_goes_in_above_one_threshold_and_out_below_the_other() -> None:
    values = np.array([0.1, 0.2, 0.1, 0.04, 0.1, np.nan, 0.2])
    assert between(values, 0.15, 0.05).tolist() == [False, True, True, False, False, False, True]


def test_when_nothing_goes_wrong_the_headline_says_so(folders: dict[str, Path]) -> None:
    found = outcome(folders["steady"])
    assert headline(found) == "2 people, both tracked to the end; no identity lost."
    assert (found.changes, found.losses, found.strays) == ((), (), ())


def test_swapped_numbers_are_two_changes_that_name_each_other(folders: dict[str, Path]) -> None:
    changes = outcome(folders["swapped"]).changes
    assert [(c.person, c.old, c.new, c.taken_from) for c in changes] == [
        ("anna", 1, 2, "ben"),
        ("ben", 2, 1, "anna"),
    ]
    assert {change.first_frame for change in changes} == {46}
    assert {change.why for change in changes} == {"was in plain sight"}


def test_who_hid_a_person_whose_number_was_lost_is_in_the_headline(folders: dict[str, Path]) -> None:
    found = outcome(folders["renumbered"])
    expected = (
        "2 people, both tracked to the end; identity lost once, at 4.0 s, when Ben was wholly hidden "
        "by Anna; 1 track on nobody."
    )
    assert headline(found).replace("\u00a0", " ") == expected
    lost = {loss.track: loss for loss in found.losses}
    assert lost[2].frame == 40
    assert lost[2].owner == "ben"
    assert lost[2].why == "was wholly hidden by Anna; its confidence was still 0.90"
    assert lost[2].afterwards.replace("\u00a0", " ") == "Ben was found after 1.4 s as number 3"
    assert lost[2].is_bad
    assert lost[4].owner == ""
    assert [(stray.track, stray.first_frame, stray.last_frame) for stray in found.strays] == [(4, 70, 79)]


def test_a_new_number_after_a_long_absence_is_no_lost_identity(tmp_path: Path) -> None:
    found = outcome(toy.write_run(tmp_path / "run", toy.away_and_back, toy.behind_from_35_to_70))
    assert headline(found) == (
        "2 people, both tracked to the end; no identity lost; once somebody came back into the image under "
        "a new number."
    )
    (loss,) = found.losses
    assert loss.why.startswith("left the image")
    assert not loss.is_bad


def test_a_story_tells_what_could_be_seen_and_what_the_tracker_had(folders: dict[str, Path]) -> None:
    ben = outcome(folders["renumbered"]).stories[1]
    assert [(Sight(s.value), s.start, s.end) for s in spans(ben.sight)] == [
        (Sight.SEEN, 0, 39),
        (Sight.WHOLLY, 39, 59),
        (Sight.SEEN, 59, 90),
    ]
    assert [Hold(span.value) for span in spans(ben.hold)] == [
        Hold.ON, Hold.NOTHING_DUE, Hold.MISSED, Hold.ON
    ]  # fmt: skip
    assert ben.hider_in(39, 59) == "anna"


def test_the_worst_moments_are_in_time_and_a_lost_identity_is_among_them(folders: dict[str, Path]) -> None:
    moments = worst_moments(outcome(folders["renumbered"]), 3)
    assert [moment.frames for moment in moments] == sorted(moment.frames for moment in moments)
    assert (39, 61) in [moment.frames for moment in moments]


def test_a_run_without_faults_shows_the_boxes_that_fit_worst(folders: dict[str, Path]) -> None:
    assert len(worst_moments(outcome(folders["steady"]), 6)) == 2


def test_curves_average_over_runs(folders: dict[str, Path]) -> None:
    outcomes = [outcome(folders[name]) for name in ("steady", "renumbered")]
    points = curve("all", outcomes, distance, found_share, DISTANCES_M).points
    # Anna is 4 m away and always found; ben is 6 m away and seen in 70 frames, in 69 of which he has a box.
    assert [point.x for point in points] == [4.5, 6.5]
    assert points[0].mean == 100.0
    assert points[1].mean == pytest.approx((100.0 + 100.0 * 69 / 70) / 2.0)
    assert points[1].sd == pytest.approx(100.0 / 70 / math.sqrt(2.0))
    assert points[1].frames == 90 + 70


def test_columns_are_named_by_what_tells_them_apart(folders: dict[str, Path]) -> None:
    by_tracker = read_columns([folders["steady"], folders["swapped"]])
    assert [column.label for column in by_tracker] == ["peopleboy", "thesis"]
    assert are_same_scene(by_tracker)
    by_scene = read_columns([folders["steady"], folders["renumbered"]])
    assert [column.label for column in by_scene] == ["toy, seed 0", "toy, seed 1"]
    assert not are_same_scene(by_scene)
    same = read_columns([folders["steady"], folders["steady"]])
    assert len({column.label for column in same}) == 2


def test_a_folder_of_runs_is_one_column_with_mean_and_spread(folders: dict[str, Path]) -> None:
    (column,) = read_columns([folders["steady"].parent])
    assert len(column.outcomes) == 3
    assert headline_of_many(column.outcomes).startswith("3 runs: of 6 people 6 tracked to the end; identity")
    found = next(line for line in plain_lines([column]) if "(CR)" in line.name)
    assert "±" in found.cells[0]


def test_more_than_four_runs_are_taken_together_by_tracker(folders: dict[str, Path]) -> None:
    runs = [folders[name] for name in ("steady", "swapped", "renumbered", "steady", "swapped")]
    columns = read_columns(runs)
    assert {column.label: len(column.outcomes) for column in columns} == {"peopleboy": 3, "thesis": 2}


def test_what_cannot_be_rendered_again_is_drawn_as_boxes(folders: dict[str, Path]) -> None:
    shown = show_frames(read_finished(folders["steady"]), [5])
    assert shown[5].origin is Origin.NONE
    assert len(np.unique(shown[5].picture.reshape(-1, 3), axis=0)) > 3


def test_images_rendered_again_are_those_that_the_run_wrote(tmp_path: Path) -> None:
    scenario = load_scenario("crossing_2").lasting(0.6)
    run(scenario, RunOptions(seed=3, out=tmp_path / "run", frames=True, record=False), lambda *_: None)
    finished = read_finished(tmp_path / "run")
    own = show_frames(finished, [2, 9])
    (tmp_path / "run" / "thermal").rename(tmp_path / "moved")
    again = show_frames(finished, [2, 9])
    assert {shown.origin for shown in own.values()} == {Origin.FRAMES}
    assert {shown.origin for shown in again.values()} == {Origin.REPLAY}
    assert all(np.array_equal(own[frame].picture, again[frame].picture) for frame in (2, 9))


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("run.json", "{"),
        ("run.json", json.dumps({"status": "complete"})),
        ("metrics.json", "[]"),
        ("events.jsonl", '{"kind": 3}\n'),
        ("truth.parquet", "no table"),
        ("truth/gt.txt", "1,2\n"),
        ("scenario.yaml", "- 1\n"),
    ],
)
def test_a_spoilt_run_is_refused_with_the_file_s_name(tmp_path: Path, file: str, content: str) -> None:
    folder = toy.write_run(tmp_path / "run")
    (folder / file).write_text(content)
    with pytest.raises(BadInput, match=file.replace(".", r"\.")):
        read_finished(folder)


def test_a_table_of_another_version_is_refused_with_the_column_that_it_lacks(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run") / "truth.parquet"
    pq.write_table(pq.read_table(path).drop_columns(["occluder"]), path)
    with pytest.raises(BadInput, match="has no column 'occluder'"):
        read_finished(path.parent)
