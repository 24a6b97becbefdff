import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner

from peopleboy.scenarios.commands.inspect_commands import evaluate
from peopleboy.tracker.evaluation.mot_files import read_truth
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.footage.footage_truth import doubts, load_truth
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import box, walker, write_folder

ENDS = {6: "", 7: ",1", 8: ",1,1", 9: ",1,-1,-1", 10: ",1,-1,-1,-1"}
WALK = [(frame, who, 20.0 * who + frame, 30.0, 10.5, 40.0) for who in (3, 7) for frame in range(1, 13)]


def written(path, rows, end=""):
    path.write_text("".join(",".join(map(str, row)) + end + "\n" for row in rows))
    return path


@pytest.mark.parametrize("count", ENDS)
@pytest.mark.parametrize("by", [0, 1])
def test_motchallenge_of_every_width_is_that_of_nine_however_it_is_sorted(tmp_path, count, by):
    rows = sorted(WALK, key=lambda row: row[by])
    given = load_truth(written(tmp_path / "theirs.txt", rows, ENDS[count]), 12)
    full = read_truth(written(tmp_path / "full.txt", rows, ",1,1,1.0"))
    assert not given.is_single
    for name in ("frame", "id", "box", "counted", "visible"):
        np.testing.assert_array_equal(getattr(given.truth, name), getattr(full, name))


@pytest.mark.parametrize("count", ENDS)
def test_one_persons_motchallenge_with_a_line_a_picture_is_no_polygon(tmp_path, count):
    rows = [(frame, 1, 50.0 + frame, 20.0, 10.0, 40.0) for frame in range(1, 13)]
    given = load_truth(written(tmp_path / "theirs.txt", rows, ENDS[count]), 12)
    assert not given.is_single
    assert given.truth.box[:, 2:].tolist() == [[10.0, 40.0]] * 12


@pytest.mark.parametrize(
    ("count", "step"), [(8, 1.0), (8, 0.5), (8, 0.0), (8, -1.0), (10, 0.5), (10, 0.0), (10, -1.0)]
)
def test_polygons_stay_polygons_whole_numbers_or_not(tmp_path, count, step):
    corners = [(4, 2), (34, 2), (34, 82), (4, 82), (4, 40)][: count // 2]
    rows = [[edge for x, y in corners for edge in (x + step * frame, y)] for frame in range(-3, 4)]
    given = load_truth(written(tmp_path / "vot.txt", rows), 7)
    assert given.is_single
    assert given.truth.box[:, 0].tolist() == [4 + step * frame for frame in range(-3, 4)]
    assert given.truth.box[0, 1:].tolist() == [2, 30, 80]


@pytest.mark.parametrize("turned", range(4))
def test_upright_rectangles_at_the_left_border_are_polygons_from_whichever_corner_on(tmp_path, turned):
    rows = [
        np.roll([[1, 2], [4 + frame, 2], [4 + frame, 6], [1, 6]], turned, axis=0).ravel()
        for frame in range(5)
    ]
    assert load_truth(written(tmp_path / "vot.txt", rows), 5).truth.box[0].tolist() == [1, 2, 3, 4]


def test_a_polygon_file_with_lines_without_the_person_stays_one(tmp_path):
    path = tmp_path / "vot.txt"
    path.write_text(f"9,2,39,2,39,82,9,82\n{','.join(['nan'] * 8)}\n{','.join(['0'] * 8)}\n")
    assert load_truth(path, 3).truth.frame.tolist() == [1]


@pytest.mark.parametrize("end", [",0.9,-1,-1,-1", ",87.5,1", ",2.5,-1,-1,-1"])
def test_a_trackers_results_are_no_truth_and_never_polygons(tmp_path, end):
    with refused(tmp_path / "theirs.txt"):
        load_truth(written(tmp_path / "theirs.txt", WALK, end), None)


def test_what_may_be_either_is_refused_with_what_would_be_right(tmp_path):
    path = written(tmp_path / "theirs.txt", WALK, ",87.5,1")
    told = refusal(write_folder(tmp_path / "clip"), "--out", tmp_path / "out", "--truth", path)
    assert_names(told, path, "8 numbers", "polygon", "frame, id, left")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("1,1,2,3,4\n", ("6 to 10 numbers",)),
        ("1,1,2,3,4,5\n2,1,2,3,4,5,1\n", (":2: ", "6 numbers")),
        ("1 1 2 3 4 x\n", ("must be numbers",)),
        ("1,1,2,3,4,5\n1,1,2,3,4,5\n", (":2: ", "once")),
        ("1,1,2,3,4,5,0.5\n", ("counted must be 0 or 1",)),
    ],
)
def test_lines_that_are_no_truth_are_refused(tmp_path, text, named):
    path = tmp_path / "gt.txt"
    path.write_text(text)
    with refused(path, *named):
        load_truth(path, None)


def test_evaluate_reads_them_and_says_that_the_visible_fraction_was_not_told(tmp_path):
    tracks = written(tmp_path / "tracks.txt", WALK, ",0.9,-1,-1,-1")
    ten = written(tmp_path / "ten.txt", WALK, ENDS[10])
    unseen = written(tmp_path / "unseen.txt", WALK, ",1,1,0")
    for truth, note in ((ten, ""), (unseen, f"{unseen}: the visible fraction is 0 in all")):
        result = CliRunner().invoke(evaluate, ["--truth", str(truth), "--tracks", str(tracks)])
        (hota,) = (line for line in result.stdout.splitlines() if line.startswith("HOTA"))
        assert "100.00 %" in hota
        assert note in result.stderr
        assert bool(note) == bool(result.stderr)


def test_in_a_run_of_ours_people_may_be_hidden_all_the_time(tmp_path):
    (tmp_path / "truth").mkdir()
    path = written(tmp_path / "truth" / "gt.txt", WALK, ",1,1,0")
    assert load_truth(path, None).notes
    (tmp_path / "truth.parquet").touch()
    given = load_truth(path, None)
    assert not given.notes
    assert not given.truth.visible.any()


def test_an_empty_file_says_that_nobody_is_there_and_that_is_told(tmp_path):
    (tmp_path / "theirs.txt").write_text("")
    given = load_truth(tmp_path / "theirs.txt", 12)
    assert len(given.truth.frame) == 0
    assert given.notes == (f"{tmp_path / 'theirs.txt'}: it is empty: no person is visible in any frame",)


WIDTH, HEIGHT = 160, 120


def boxes(rows):
    table = np.array(rows, dtype=np.float64)
    ones = np.ones(len(table))
    frame = np.arange(len(table)) + 1
    return TrueBoxes(frame=frame, id=ones, box=table, counted=ones > 0, visible=ones)


def crossing(scale=1.0):
    return boxes([[scale * edge for edge in (x, 30.0, 20.0, 60.0)] for x in range(-10, 150, 4)])


def numbered(tmp_path: Path, first: int, count: int = 6) -> Path:
    clip = tmp_path / "clip"
    clip.mkdir()
    for frame in range(count):
        cv2.imwrite(str(clip / f"cam2_{first + frame:05d}.png"), walker(frame))
    return clip


def told(tmp_path, clip, frames):
    """Track with truth of these frames; give what notes say of it, and the frames it was written with."""
    truth, out = tmp_path / "truth.txt", tmp_path / "out"
    truth.write_text("".join(f"{f},4,{','.join(map(str, box(k)))},1,1,1\n" for k, f in enumerate(frames)))
    result = call(clip, "--out", out, "--truth", truth)
    assert result.exit_code == 0, result.output
    notes = [note for note in json.loads((out / "run.json").read_text())["notes"] if str(truth) in note]
    assert [line for line in result.stderr.splitlines() if str(truth) in line] == [
        f"peopleboy: note: {note}" for note in notes
    ]
    first_tracked = (out / "tracks.txt").read_text().split(",")[0]
    assert first_tracked in ("", *map(str, range(1, 7)))
    return notes, load_truth(out / "truth" / "gt.txt", None).truth.frame.tolist()


@pytest.mark.parametrize(
    ("first", "frames", "words", "taken"),
    [
        (1, range(1, 7), None, [1, 2, 3, 4, 5, 6]),
        (11, range(11, 17), "11 to 16", [1, 2, 3, 4, 5, 6]),
        (11, (13, 16), "11 to 16", [3, 6]),
        (11, range(1, 7), "first picture, which has number 11", [1, 2, 3, 4, 5, 6]),
        (3, (1, 2, 6), "first picture, which has number 3", [1, 2, 6]),
        (0, range(6), "0 to 5", [1, 2, 3, 4, 5, 6]),
        (0, range(1, 6), "first picture, which has number 0", [1, 2, 3, 4, 5]),
    ],
)
def test_frames_that_are_the_pictures_numbers_are_taken_so_and_it_is_said(
    tmp_path, first, frames, words, taken
):
    notes, found = told(tmp_path, numbered(tmp_path, first), frames)
    assert found == taken
    assert len(notes) == (words is not None)
    assert words is None or words in notes[0]


@pytest.mark.parametrize("scale", [1.5, 2.0, 4.0, 0.45, 0.3])
def test_boxes_of_pictures_of_another_size_raise_doubts(scale):
    (note,) = doubts(crossing(scale), WIDTH, HEIGHT)
    assert "160x120" in note
    assert "another size" in note


@pytest.mark.parametrize(
    "rows",
    [
        [],
        [[x, 30, 20, 60] for x in range(-19, 159, 3)],  # in at one side and out at the other
        [[60, 100 - y, 400, 40 * y] for y in range(1, 80)],  # comes so near that only the hair is seen
        [[-300, -200, 500, 900]],
        [[x, 10, 4, 12] for x in range(10, 30)],  # far away, in a corner
        [[x, 10, 4, 12] for x in range(10, 90)],  # and across the middle
    ],
)
def test_people_partly_outside_near_or_far_raise_none(rows):
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    assert doubts(boxes(table), WIDTH, HEIGHT) == []


def test_doubts_are_told_with_the_scores(tmp_path):
    clip = numbered(tmp_path, 1)
    truth = tmp_path / "large.txt"
    truth.write_text("".join(f"{f},4,{400 + f},90,40,200\n" for f in range(1, 7)))
    result = call(clip, "--out", tmp_path / "out", "--truth", truth)
    assert "note: truth: 100% of the boxes are outside" in result.stderr


def test_the_protocol_of_rows_that_protocols_score_in_different_ways_is_noted(tmp_path):
    path = tmp_path / "gt.txt"
    path.write_text("1,1,2,3,4,5,1,1,0\n2,1,2,3,4,5,1,1,1\n2,2,9,3,4,5,1,6,1\n")
    (note,) = load_truth(path, None).notes
    assert_names(note, "mot17", "class 6", "mot20", "--protocol")
    path.write_text("1,1,2,3,4,5,1,1,0.5\n")
    assert not load_truth(path, None).notes


@pytest.mark.parametrize(
    ("place", "protocol"),
    [
        ("MOT20/train/MOT20-01/gt", "mot20"),
        ("2DMOT2015/train/TUD-Campus/gt", "mot15"),
        ("DanceTrack/val/dancetrack0004/gt", "dancetrack"),
        ("mot17-results/MOT16-02/gt", "mot16"),
        ("sequences/one/gt", "mot17"),
    ],
)
def test_the_path_of_a_truth_file_names_its_protocol(tmp_path, place, protocol):
    path = tmp_path / place / "gt.txt"
    path.parent.mkdir(parents=True)
    path.write_text("1,1,2,3,4,5,1,1,0\n")
    assert load_truth(path, None).protocol == protocol
    (path.parent.parent / "seqinfo.ini").write_text("[Sequence]\nname=MOT20-05\n")
    assert load_truth(path, None).protocol == "mot20"
    assert load_truth(path, None, protocol="kitti").protocol == "kitti"


def test_visible_fractions_in_per_cent_are_read_as_such(tmp_path):
    path = tmp_path / "gt.txt"
    path.write_text("1,1,2,3,4,5,1,1,80\n2,1,2,3,4,5,1,1,100\n")
    given = load_truth(path, None)
    assert given.truth.visible.tolist() == [0.8, 1.0]
    assert "per cent" in given.notes[0]


def test_visdrone_has_categories_flags_occlusion_and_regions(tmp_path):
    path = tmp_path / "uav0000.txt"
    path.write_text(
        "1,1,10,10,20,60,1,1,0,0\n1,2,50,10,20,60,1,2,0,1\n1,3,90,10,20,60,0,1,0,2\n"
        "1,4,130,10,60,30,1,4,0,0\n1,0,200,0,80,80,0,0,0,0\n1,0,300,0,80,80,0,0,0,0\n"
    )
    given = load_truth(path, None)
    assert given.protocol == "visdrone"
    assert given.truth.id.tolist() == [1, 2, 3]
    assert given.truth.counted.tolist() == [True, True, False]
    assert given.truth.visible.tolist() == [1.0, 0.75, 0.25]
    assert (len(given.around.objects), len(given.around.regions)) == (1, 2)
