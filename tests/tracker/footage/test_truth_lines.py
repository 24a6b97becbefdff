import numpy as np
import pytest
from click.testing import CliRunner

from peopleboy.scenarios.commands.evaluate import evaluate
from peopleboy.tracker.evaluation.mot_files import read_truth
from peopleboy.tracker.footage.truth_files import load_truth
from tests.helpers.calls.footage_calls import refusal
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.images.footage_files import write_folder

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
        ("1 1 2 3 4 5\n", ("comma",)),
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
    assert given.notes == (f"{tmp_path / 'theirs.txt'}: it is empty, which says that nobody is there",)
