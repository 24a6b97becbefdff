from __future__ import annotations

import json
import math
import shutil
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from statistics import fmean, stdev

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.report.charts.error_curves import curve, distance_edges, samples
from peopleboy.scenarios.report.charts.timeline_rows import ASIDE, hidden_words, track_row, truth_row
from peopleboy.scenarios.report.charts.timelines import rgb, track_edges
from peopleboy.scenarios.report.columns import are_same_scene, lacking, read_columns
from peopleboy.scenarios.report.findings.histories import TrackingState, Visibility, between, settle, spans
from peopleboy.scenarios.report.findings.identity_changes import ChangeKind, Outcome
from peopleboy.scenarios.report.findings.run_findings import RunFindings, analyse_run, headline, worst_moments
from peopleboy.scenarios.report.page_tables import drive_figures, plain_figures
from peopleboy.scenarios.report.pictures import Origin, show_frames
from peopleboy.scenarios.report.report_page import write_report
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.tracker.evaluation.occlusion_scores import TOTAL_ENDS, find_occlusions
from peopleboy.tracker.evaluation.sequence import TrackBoxes
from tests.helpers.runs import toy_runs as toy

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


def found_in(folder: Path) -> RunFindings:
    return analyse_run(open_run(folder))


def plain(words: str) -> str:
    return words.replace("\N{NO-BREAK SPACE}", " ")


def endings(found: RunFindings) -> list[list[str]]:
    """Who was tracked to the end, hidden until then, and lost."""
    return [found.people_with(ending) for ending in (Outcome.TRACKED, Outcome.HIDDEN, Outcome.LOST)]


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


def test_when_nothing_goes_wrong_nothing_is_found(folders: dict[str, Path]) -> None:
    found = found_in(folders["steady"])
    assert endings(found) == [["Anna", "Ben"], [], []]
    assert (found.changes, found.losses, found.false_tracks) == ([], [], [])


def test_swapped_numbers_are_two_changes_that_name_each_other(folders: dict[str, Path]) -> None:
    changes = found_in(folders["swapped"]).changes
    assert [(c.person, c.old, c.new, c.taken_from) for c in changes] == [
        ("anna", 1, 2, "ben"),
        ("ben", 2, 1, "anna"),
    ]
    assert {change.first_frame for change in changes} == {46}
    assert {str(change.cause) for change in changes} == {"was in plain sight"}


def test_a_lost_number_tells_who_hid_the_person_and_what_came_then(folders: dict[str, Path]) -> None:
    found = found_in(folders["renumbered"])
    assert endings(found) == [["Anna", "Ben"], [], []]
    (change,) = found.lost
    assert (change.person, change.old, change.new, change.last_frame, change.first_frame) == (
        "ben", 2, 3, 39, 61,
    )  # fmt: skip
    assert str(change.cause) == "was wholly hidden by Anna"
    lost = {loss.track: loss for loss in found.losses}
    assert (lost[2].frame, lost[2].owner, lost[2].is_bad) == (40, "ben", True)
    assert lost[2].why.startswith(f"{change.cause}; ")
    assert "0.90" in lost[2].why
    assert "number 3" in lost[2].afterwards
    assert lost[4].owner == ""
    assert [(stray.track, stray.first_frame, stray.last_frame) for stray in found.false_tracks] == [
        (4, 70, 79)
    ]


def test_a_new_number_for_good_is_a_lost_identity_after_an_absence_too(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.away_and_back, toy.behind_from_35_to_70))
    assert endings(found) == [["Anna", "Ben"], [], []]
    (change,) = found.lost
    assert change.is_return
    (loss,) = found.losses
    assert loss.why.startswith("left the image")
    assert loss.is_bad
    assert "identity lost once, at 4.7" in plain(headline([found]))


def test_who_is_known_again_within_a_second_is_not_lost(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.known_late, toy.behind_from_35_to_70))
    assert (found.lost, found.transfers) == ([], [])
    (change,) = found.reidentified
    assert (change.old, change.new, change.reidentified_after_s) == (5, 2, pytest.approx(7 / 15))
    assert [(loss.track, loss.is_bad) for loss in found.losses] == [(2, False)]  # 5 went on as 2
    assert plain(headline([found])).endswith(
        "no identity lost; Ben was re-identified as number 2 after 0.5 s as number 5."
    )
    lost = found_in(toy.write_run(tmp_path / "lost", toy.away_and_back, toy.behind_from_35_to_70))
    assert found.faults < lost.faults


def test_a_number_that_goes_to_somebody_else_comes_first(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.passed_on))
    (one,) = found.transfers
    assert (one.number, one.giver, one.receiver, one.first_frame) == (1, "anna", "ben", 46)
    assert plain(headline([found])).startswith("Number 1 passed from Anna to Ben at 3.0 s, when Anna was ")
    assert "no identity lost" not in headline([found])
    (loss,) = found.losses
    assert plain(loss.afterwards).startswith("shown again after 0.4 s, on Ben; Anna was ")
    assert loss.is_bad
    assert "a number passed to another person twice, in 2 runs" in headline([found, found])
    assert max(worst_moments(found, 3)).title == "Number 1 passes from Anna to Ben"
    assert "which was Anna's" in track_row(found, found.called("ben")).words


def test_a_number_that_is_back_at_once_went_to_nobody(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.swapped_for_a_moment))
    assert found.transfers == []
    assert [change.turn for change in found.changes] == [
        ChangeKind.TAKEN,
        ChangeKind.TAKEN,
        ChangeKind.BACK,
        ChangeKind.BACK,
    ]


def test_a_track_that_is_shown_again_on_nobody_is_said_to_be(tmp_path: Path) -> None:
    (loss,) = found_in(toy.write_run(tmp_path / "run", toy.again_on_nobody)).losses
    assert plain(loss.afterwards) == "shown again after 0.7 s, on no person; Ben was not found again"
    assert loss.is_bad


def test_a_person_who_is_shown_again_for_a_moment_is_not_said_to_be_unfound(tmp_path: Path) -> None:
    first, last = found_in(toy.write_run(tmp_path / "run", toy.again_for_a_moment)).losses
    assert (plain(first.afterwards), first.is_bad) == ("shown again after 0.7 s, same number", False)
    assert (plain(last.afterwards), last.is_bad) == ("Ben was not found again", True)


def test_a_loss_during_a_fault_says_so(tmp_path: Path) -> None:
    dark = FaultSpec(kind="camera_black", from_s=1.0, lasts_s=2.0)
    during, after = (
        found_in(toy.write_run(tmp_path / name, boxes, faults=[dark])).losses[0]
        for name, boxes in (("during", toy.away_and_back), ("after", toy.until_75))
    )
    assert "during the fault camera_black; " in during.why
    assert "fault" not in after.why


def test_a_reason_is_true_of_its_moment_and_what_was_just_before_is_said_to_be(tmp_path: Path) -> None:
    (loss,) = found_in(toy.write_run(tmp_path / "run", toy.until_75, lambda f: 0.5 * (f == 72))).losses
    assert loss.why.startswith("was in plain sight, but had just been hidden to 50% by Anna; ")


def test_losses_that_are_listed_and_left_out_are_those_of_the_log(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.flickering))
    assert [(loss.track, loss.frame) for loss in found.losses] == [(2, 50)]
    assert (found.short_losses.breaks, found.short_losses.ends) == (1, 1)
    assert sum(line.kind == "lost" for line in found.run.events) == 3


@given(steps=st.lists(st.tuples(st.integers(1, 8), st.booleans()), min_size=1, max_size=25))
def test_no_loss_of_the_log_is_counted_twice_or_not_at_all(
    folders: dict[str, Path], steps: list[tuple[int, bool]]
) -> None:
    steady = found_in(folders["steady"])
    tracks = steady.files.tracks
    shown = np.concatenate([np.full(length, is_shown) for length, is_shown in steps])[: steady.run.frames]
    frames = np.flatnonzero(shown) + 1
    at = np.flatnonzero((tracks.id == 2) & np.isin(tracks.frame, frames))
    columns = {name: getattr(tracks, name)[at] for name in ("frame", "id", "box", "confidence")}
    found = RunFindings(run=steady.run, files=replace(steady.files, tracks=TrackBoxes(**columns)))
    lost = sum(before and frame not in frames for frame, before in enumerate(np.isin(range(91), frames), 1))
    ends_with_run = int(found.run.frames in frames)
    assert len(found.losses) + found.short_losses.breaks + found.short_losses.ends == lost - ends_with_run


def test_a_loss_gives_the_tracker_s_own_reason_and_names_on_whom_the_other_track_lay(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run", toy.until_75, toy.hidden_from_75) / "events.jsonl"
    assert found_in(path.parent).losses[0].believed == "not detected any more, confidence 0.90"
    hidden = "occluded by track 1 for too long"
    path.write_text(path.read_text().replace("not detected any more, confidence 0.90", hidden))
    (loss,) = found_in(path.parent).losses
    assert loss.believed == "occluded by number 1 (on Anna) for too long"


def test_who_is_hidden_until_the_end_is_neither_tracked_to_the_end_nor_lost(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", toy.until_75, toy.hidden_from_75))
    assert endings(found) == [["Anna"], ["Ben"], []]
    assert "of 4 people 2 tracked to the end, 2 hidden until the end" in headline([found, found])
    (loss,) = found.losses
    assert (loss.owner, loss.is_bad) == ("ben", False)


def test_who_is_lost_in_the_last_second_is_not_said_to_be_lost_for_good(tmp_path: Path) -> None:
    found = found_in(toy.write_run(tmp_path / "run", lambda frame: toy.until_75(frame - 6)))
    assert endings(found) == [["Anna", "Ben"], [], []]
    (loss,) = found.losses
    assert not loss.is_bad
    early = found_in(toy.write_run(tmp_path / "early", toy.until_75))
    assert endings(early) == [["Anna"], [], ["Ben"]]
    assert early.losses[0].is_bad


def test_numbers_of_one_colour_have_different_edges() -> None:
    assert rgb(1) == rgb(7)
    assert len({(rgb(number), track_edges(number)) for number in range(1, 55)}) == 54


def test_a_history_tells_what_could_be_seen_and_what_the_tracker_had(folders: dict[str, Path]) -> None:
    found = found_in(folders["renumbered"])
    ben = found.called("ben")
    assert [(Visibility(s.value), s.start, s.end) for s in spans(ben.view)] == [
        (Visibility.SEEN, 0, 39),
        (Visibility.WHOLLY, 39, 59),
        (Visibility.SEEN, 59, 90),
    ]
    assert [TrackingState(span.value) for span in spans(ben.state)] == [
        TrackingState.ON, TrackingState.NOT_DUE, TrackingState.MISSED, TrackingState.ON
    ]  # fmt: skip
    assert ben.hider_in(39, 59) == "anna"
    assert [(start, end, look.kind, look.text) for start, end, look in truth_row(found, ben).bars] == [
        (0.0, 39 / 15, "seen", "seen"),
        (39 / 15, 59 / 15, "wholly", "by Anna"),
        (59 / 15, 6.0, "seen", "seen"),
    ]
    row = track_row(found, ben)
    assert [(look.kind, look.track) for _, _, look in row.bars] == [("on", 2), ("missed", 0), ("on", 3)]
    assert [time_s for time_s, _ in row.marks] == [4.0]


@pytest.mark.slow
@given(data=st.data())
def test_the_bars_of_a_row_lie_end_to_end_where_there_is_something(
    folders: dict[str, Path], data: st.DataObject
) -> None:
    found = found_in(folders["renumbered"])
    view = np.array(data.draw(st.lists(st.integers(0, 3), min_size=90, max_size=90)), np.int64)
    is_counted = np.array(data.draw(st.lists(st.booleans(), min_size=90, max_size=90)))
    row = truth_row(found, replace(found.called("ben"), view=view, is_counted=is_counted))
    kinds, asides = np.full(90, "nothing"), np.zeros(90, np.bool_)
    for start, end, look in row.bars:
        here = slice(round(start * 15), round(end * 15))
        assert (kinds[here] == "nothing").all()
        kinds[here], asides[here] = look.kind, ASIDE in look.words
    is_there = view != Visibility.AWAY
    assert np.array_equal(kinds != "nothing", is_there)
    assert np.array_equal(kinds == "wholly", view == Visibility.WHOLLY)
    assert np.array_equal(asides, is_there & ~is_counted)


def test_the_worst_moments_are_in_time_and_a_lost_identity_is_among_them(folders: dict[str, Path]) -> None:
    moments = worst_moments(found_in(folders["renumbered"]), 3)
    assert [moment.frames for moment in moments] == sorted(moment.frames for moment in moments)
    assert (39, 61) in [moment.frames for moment in moments]


def test_a_run_without_faults_shows_the_boxes_that_fit_worst(folders: dict[str, Path]) -> None:
    assert len(worst_moments(found_in(folders["steady"]), 6)) == 2


def test_curves_average_over_runs(folders: dict[str, Path]) -> None:
    runs = [found_in(folders[name]) for name in ("steady", "renumbered")]
    edges = distance_edges(runs)
    assert edges == tuple(range(3, 11))
    points = curve([samples(found) for found in runs], "distance", "found", edges)
    # Anna is 4 m away and always found; ben is 6 m away and seen in 70 frames, in 69 of which he has a box.
    assert [point.x for point in points] == [4.5, 6.5]
    assert points[0].mean == 100.0
    assert points[1].mean == pytest.approx((100.0 + 100.0 * 69 / 70) / 2.0)
    assert points[1].sd == pytest.approx(100.0 / 70 / math.sqrt(2.0))
    assert points[1].boxes == 90 + 70


def test_columns_are_named_by_what_tells_them_apart(folders: dict[str, Path]) -> None:
    by_tracker = read_columns([folders["steady"], folders["swapped"]])
    assert [column.label for column in by_tracker] == ["detection", "thesis"]
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
    assert len(column.runs) == 3
    assert column.headline.startswith(
        "3 runs: a number passed to another person twice, in 1 run; of 6 people 6 tracked to the end; "
    )
    row = next(row for row in plain_figures([column]).rows if "(CR)" in row[0])
    values = [scores.thesis.cr for scores in column.scores]
    assert row[1] == f"{fmean(values):.1f} ± {stdev(values):.1f} %"


@pytest.mark.slow
def test_two_sweeps_give_the_difference_of_their_pairs_with_an_interval(tmp_path: Path) -> None:
    for seed in range(4):
        toy.write_run(tmp_path / "one" / str(seed), toy.renumbered, seed=seed)
        toy.write_run(tmp_path / "two" / str(seed), tracker="thesis", seed=seed)
    columns = read_columns([tmp_path / "one", tmp_path / "two"])
    row = next(row for row in plain_figures(columns).rows if "(CR)" in row[0])
    mean = columns[1].scores[0].thesis.cr - columns[0].scores[0].thesis.cr
    assert row[3] == f"{mean:+.1f} [{mean:+.1f}, {mean:+.1f}]"  # each pair differs alike


def test_more_than_four_runs_are_taken_together_by_tracker(folders: dict[str, Path], tmp_path: Path) -> None:
    again = [shutil.copytree(folders[name], tmp_path / name) for name in ("steady", "swapped")]
    columns = read_columns([*folders.values(), *again])
    assert {column.label: len(column.runs) for column in columns} == {"detection": 3, "thesis": 2}


def test_what_cannot_be_rendered_again_is_drawn_as_boxes(folders: dict[str, Path]) -> None:
    shown = show_frames(found_in(folders["steady"]), [5])
    assert shown[5].origin is Origin.CHANGED
    assert len(np.unique(shown[5].picture.reshape(-1, 3), axis=0)) > 3


def test_images_are_the_run_s_own_else_rendered_again_else_boxes_where_pybullet_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = load_scenario("crossing_2").lasting(0.6)
    run(scenario, RunOptions(seed=3, out=tmp_path / "run", frames=True, record=False), lambda *_: None)
    found = found_in(tmp_path / "run")
    own = show_frames(found, [2, 9])
    (tmp_path / "run" / "thermal_scene" / "000009.png").rename(tmp_path / "moved.png")
    again = show_frames(found, [2, 9])
    assert {still.origin for still in own.values()} == {Origin.FRAMES}
    assert [again[frame].origin for frame in (2, 9)] == [Origin.FRAMES, Origin.REPLAY]
    assert all(np.array_equal(own[frame].picture, again[frame].picture) for frame in (2, 9))
    monkeypatch.setitem(sys.modules, "pybullet", None)
    without = show_frames(found, [2, 9])
    assert [without[frame].origin for frame in (2, 9)] == [Origin.FRAMES, Origin.NO_PHYSICS]
    assert np.array_equal(own[2].picture, without[2].picture)


@pytest.mark.slow
def test_a_run_with_a_recording_is_not_played_again_for_its_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = load_scenario("crossing_2").lasting(0.6)
    run(scenario, RunOptions(seed=3, out=tmp_path / "run", lossless=True), lambda *_: None)
    found = found_in(tmp_path / "run")
    monkeypatch.setitem(sys.modules, "pybullet", None)
    quick = show_frames(found, [2, 9])
    assert [quick[frame].origin for frame in (2, 9)] == [Origin.RECORDING] * 2
    monkeypatch.undo()
    (tmp_path / "run" / "recording.rrd").write_bytes(b"RRF2 spoilt")
    again = show_frames(found, [2, 9])
    assert [again[frame].origin for frame in (2, 9)] == [Origin.REPLAY] * 2
    assert all(np.array_equal(quick[frame].picture, again[frame].picture) for frame in (2, 9))


def test_times_hidden_are_told_as_they_are_scored(folders: dict[str, Path]) -> None:
    found = found_in(folders["steady"])
    rate = found.run.rate_hz
    occluded = np.array([0.0, 0.2, 0.6, 0.99, 0.95, 0.91, 0.3, 0.0, 0.0, 0.4, 0.0])
    view = np.array([1, 2, 2, 3, 3, 3, 2, 1, 1, 2, 1])
    hider = ("", *("ben",) * 6, "", "", "eve", "")
    person = replace(found.people[0], occluded=occluded, view=view, hider=hider)
    times = [f"{frame / rate:.1f}" for frame in (1, 7, 9, 10)]
    assert hidden_words(found, person).replace("\N{NO-BREAK SPACE}", " ") == (
        f"Hidden wholly for {3 / rate:.1f} s by Ben (in all {times[0]} to {times[1]} s), "
        f"to 40% by Eve ({times[2]} to {times[3]} s)."
    )
    ((start, end),) = find_occlusions(np.arange(11), occluded)
    assert (occluded[start:end] >= TOTAL_ENDS).sum() == 3


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
        write_report([folder], tmp_path / "page.html")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


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
    assert line.endswith("the plan and images rendered again are missing; run the scenario again to get them")
    assert column.headline == whole.headline


def test_a_table_of_another_version_is_refused_with_the_column_that_it_lacks(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run") / "truth.parquet"
    pq.write_table(pq.read_table(path).drop_columns(["occluder"]), path)
    with pytest.raises(BadInput, match="has no column 'occluder'"):
        found_in(path.parent)


def test_metrics_of_another_version_are_refused_with_their_group(tmp_path: Path) -> None:
    path = toy.write_run(tmp_path / "run") / "metrics.json"
    path.write_text(json.dumps({"following": {"unheard_of": 1.0}}))
    with pytest.raises(BadInput, match=r"metrics\.json: following: not the metrics of this version"):
        drive_figures(read_columns([path.parent]), "following")
