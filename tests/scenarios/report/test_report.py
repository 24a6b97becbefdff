from __future__ import annotations

import json
import math
import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.report.charts.charts import rgb, track_edges
from peopleboy.scenarios.report.charts.thermal_stills import Origin, show_frames
from peopleboy.scenarios.report.columns import are_same_scene, lacking, read_columns
from peopleboy.scenarios.report.figure_tables import plain_lines
from peopleboy.scenarios.report.findings.errors import DISTANCES_M, curve, distance, found_share
from peopleboy.scenarios.report.findings.finished_run import read_finished
from peopleboy.scenarios.report.findings.identities import count_fleeting, find_losses
from peopleboy.scenarios.report.findings.spans import between, settle, spans
from peopleboy.scenarios.report.findings.story import Hold, Sight
from peopleboy.scenarios.report.findings.summary import Outcome, headline, headline_of_many, look_into
from peopleboy.scenarios.report.findings.worst_moments import worst_moments
from peopleboy.scenarios.running.run import RunOptions, run
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from tests.helpers import toy_runs as toy

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


def test_losses_that_are_listed_and_left_out_are_those_of_the_log(tmp_path: Path) -> None:
    found = outcome(toy.write_run(tmp_path / "run", toy.flickering))
    assert [(loss.track, loss.frame) for loss in found.losses] == [(2, 50)]
    assert (found.fleeting.breaks, found.fleeting.ends) == (1, 1)
    assert sum(line.kind == "lost" for line in found.run.events) == 3
    assert found.fleeting.words == (
        "Losses of less than 0.3 s (1 of them) are left out: the same number was shown again. "
        "Ends of tracks that had been shown for less than 0.3 s (1 of them) are left out. "
        "All of them are in events.jsonl."
    )


@given(steps=st.lists(st.tuples(st.integers(1, 8), st.booleans()), min_size=1, max_size=25))
def test_no_loss_of_the_log_is_counted_twice_or_not_at_all(
    folders: dict[str, Path], steps: list[tuple[int, bool]]
) -> None:
    steady = read_finished(folders["steady"])
    shown = np.concatenate([np.full(length, is_shown) for length, is_shown in steps])[: steady.frames]
    frames = np.flatnonzero(shown) + 1
    at = np.flatnonzero((steady.tracks.id == 2) & np.isin(steady.tracks.frame, frames))
    columns = {name: getattr(steady.tracks, name)[at] for name in ("frame", "id", "box", "confidence")}
    run = replace(steady, tracks=TrackBoxes(**columns))
    lost = sum(before and frame not in frames for frame, before in enumerate(np.isin(range(91), frames), 1))
    fleeting, listed = count_fleeting(run), find_losses(run, [])
    ends_with_run = int(run.frames in frames)
    assert len(listed) + fleeting.breaks + fleeting.ends == lost - ends_with_run


def test_a_loss_gives_the_tracker_s_own_reason_and_names_on_whom_the_other_track_lay(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run", toy.until_75, toy.hidden_from_75) / "events.jsonl"
    assert outcome(path.parent).losses[0].believed == "the contour is gone, confidence 0.90"
    hidden = "hidden by track 1 for too long to know where"
    path.write_text(path.read_text().replace("the contour is gone, confidence 0.90", hidden))
    (loss,) = outcome(path.parent).losses
    assert loss.believed == "hidden by number 1 (on Anna) for too long to know where"


def test_who_is_hidden_until_the_end_is_neither_tracked_to_the_end_nor_lost(tmp_path: Path) -> None:
    found = outcome(toy.write_run(tmp_path / "run", toy.until_75, toy.hidden_from_75))
    assert headline(found) == (
        "2 people, all but Ben tracked to the end (Ben hidden until the end); no identity lost."
    )
    assert "of 2 people 1 tracked to the end, 1 hidden until the end" in headline_of_many([found])
    (loss,) = found.losses
    assert (loss.afterwards, loss.is_bad) == ("Ben was hidden until the end", False)


def test_who_is_lost_in_the_last_second_is_not_said_to_be_lost_for_good(tmp_path: Path) -> None:
    found = outcome(toy.write_run(tmp_path / "run", lambda frame: toy.until_75(frame - 6)))
    assert headline(found) == "2 people, both tracked to the end; no identity lost."
    (loss,) = found.losses
    assert loss.afterwards.replace("\u00a0", " ") == "the run ended 0.7 s later"
    early = outcome(toy.write_run(tmp_path / "early", toy.until_75))
    assert headline(early) == "2 people, all but Ben tracked to the end; no identity lost."
    assert early.losses[0].afterwards == "Ben was not found again"


def test_numbers_of_one_colour_have_different_edges() -> None:
    assert rgb(1) == rgb(7)
    assert len({(rgb(number), track_edges(number)) for number in range(1, 55)}) == 54


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


def test_runs_of_one_scene_and_tracker_are_told_apart_by_their_folders(
    folders: dict[str, Path], tmp_path: Path
) -> None:
    again = shutil.copytree(folders["steady"], tmp_path / "again")
    assert [column.label for column in read_columns([folders["steady"], again])] == ["steady", "again"]


def test_a_run_is_not_held_against_itself(folders: dict[str, Path]) -> None:
    steady = folders["steady"]
    for paths in ([steady, steady], [steady.parent, steady / ".." / "steady"]):
        with pytest.raises(BadInput, match="is given twice"):
            read_columns(paths)


def test_a_folder_of_runs_is_one_column_with_mean_and_spread(folders: dict[str, Path]) -> None:
    (column,) = read_columns([folders["steady"].parent])
    assert len(column.outcomes) == 3
    assert headline_of_many(column.outcomes).startswith("3 runs: of 6 people 6 tracked to the end; identity")
    found = next(line for line in plain_lines([column]) if "(CR)" in line.name)
    assert "±" in found.cells[0]


def test_more_than_four_runs_are_taken_together_by_tracker(folders: dict[str, Path], tmp_path: Path) -> None:
    again = [shutil.copytree(folders[name], tmp_path / name) for name in ("steady", "swapped")]
    columns = read_columns([*folders.values(), *again])
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
    ],
)
def test_a_spoilt_run_is_refused_with_the_file_s_name(tmp_path: Path, file: str, content: str) -> None:
    folder = toy.write_run(tmp_path / "run")
    (folder / file).write_text(content)
    with pytest.raises(BadInput, match=file.replace(".", r"\.")):
        read_finished(folder)


@pytest.mark.parametrize("content", [None, "- 1\n", "{", "name: toy\n"])
def test_a_run_whose_scenario_is_missing_or_spoilt_is_reported_on_and_says_so(
    tmp_path: Path, content: str | None
) -> None:
    path = toy.write_run(tmp_path / "run", scenario=load_scenario("crossing_2").resolved(0)) / "scenario.yaml"
    (whole,) = read_columns([path.parent])
    assert lacking([whole]) == []
    path.unlink()
    if content is not None:
        path.write_text(content)
    (column,) = read_columns([path.parent])
    (line,) = lacking([column])
    assert line.startswith(f"{path}: ")
    assert line.endswith("no plan is drawn and no image rendered again; run the scenario again for them")
    assert column.headline == whole.headline


def test_a_table_of_another_version_is_refused_with_the_column_that_it_lacks(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run") / "truth.parquet"
    pq.write_table(pq.read_table(path).drop_columns(["occluder"]), path)
    with pytest.raises(BadInput, match="has no column 'occluder'"):
        read_finished(path.parent)
