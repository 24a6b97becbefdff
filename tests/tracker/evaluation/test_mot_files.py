import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from numpy.testing import assert_allclose

from peopleboy.tracker.evaluation.mot_files import read_tracks, read_truth, write_tracks, write_truth
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import sequences, tracks_of, truth_of

GOOD_TRUTH = "1,1,10.00,20.00,30.00,80.00,1,1,0.5000\n"
GOOD_TRACKS = "1,1,10.00,20.00,30.00,80.00,0.9000,-1,-1,-1\n"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(sequences())
def test_what_is_written_reads_back_to_the_written_decimals(tmp_path, sequence):
    truth, tracks = sequence
    write_truth(tmp_path / "gt.txt", truth)
    write_tracks(tmp_path / "tracks.txt", tracks)
    truth_again, tracks_again = read_truth(tmp_path / "gt.txt"), read_tracks(tmp_path / "tracks.txt")
    for name in ("frame", "id", "counted"):
        assert np.array_equal(getattr(truth_again, name), getattr(truth, name))
    assert np.array_equal(tracks_again.id, tracks.id)
    assert_allclose(truth_again.box, truth.box, atol=0.00501)
    assert_allclose(tracks_again.box, tracks.box, atol=0.00501)
    assert_allclose(truth_again.visible, truth.visible, atol=0.0000501)
    assert_allclose(tracks_again.confidence, tracks.confidence, atol=0.0000501)


def test_lines_are_formatted_as_motchallenge_says(tmp_path):
    write_truth(
        tmp_path / "gt.txt", truth_of([(2, 7, -0.001, 1.005, 30, 80.126)], counted=False, visible=0.25)
    )
    write_tracks(tmp_path / "tracks.txt", tracks_of([(2, 7, 1, 2, 3, 4), (1, 9, 5, 6, 7, 8)]))
    assert (tmp_path / "gt.txt").read_bytes() == b"2,7,0.00,1.00,30.00,80.13,0,1,0.2500\n"
    assert (tmp_path / "tracks.txt").read_bytes() == (
        b"1,9,5.00,6.00,7.00,8.00,1.0000,-1,-1,-1\n2,7,1.00,2.00,3.00,4.00,1.0000,-1,-1,-1\n"
    )


def test_an_empty_file_has_nobody_and_nobody_makes_an_empty_file(tmp_path):
    path = tmp_path / "empty.txt"
    write_tracks(path, tracks_of([]))
    assert path.read_bytes() == b""
    assert len(read_tracks(path)) == len(read_truth(path)) == 0


def test_spaces_windows_line_ends_and_a_missing_last_newline_are_fine(tmp_path):
    path = tmp_path / "tracks.txt"
    path.write_bytes(b"2, 3, 10.5, 20, 30, 80, 1, -1, -1, -1\r\n1.0,3,1,2,3,4,0.5,-1,-1,-1")
    tracks = read_tracks(path)
    assert tracks.frame.tolist() == [1, 2]
    assert tracks.box[1].tolist() == [10.5, 20.0, 30.0, 80.0]
    path.write_bytes(b"2,3,10.5,20,30,80,1,-1,-1,-1\r\n\r\n\n")
    assert read_tracks(path).frame.tolist() == [2]


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("1,1,10,20,30,80,1,1", ("9 numbers",)),
        ("", ("9 numbers",)),
        ("1,2,10,twenty,30,80,1,1,1", ("numbers",)),
        ("1,2,10,,30,80,1,1,1", ("numbers",)),
        ("0,2,10,20,30,80,1,1,1", ("frame", "from 1", "got 0")),
        ("1.5,2,10,20,30,80,1,1,1", ("frame", "whole", "got 1.5")),
        ("1e300,2,10,20,30,80,1,1,1", ("frame", "whole")),
        ("1,-2,10,20,30,80,1,1,1", ("id", "from 0", "got -2")),
        ("1,2,nan,20,30,80,1,1,1", ("nan, 20, 30, 80",)),
        ("1,2,10,inf,30,80,1,1,1", ("10, inf, 30, 80",)),
        ("1,2,10,20,-30,80,1,1,1", ("width", "height", "10, 20, -30, 80")),
        ("1,1,11,20,30,80,1,1,1", ("id", "once", "got 1")),
        ("1,2,10,20,30,80,2,1,1", ("counted", "0 or 1", "got 2")),
        ("1,2,10,20,30,80,1,14,1", ("class", "13", "got 14")),
        ("1,2,10,20,30,80,1,1,1.1", ("visible fraction", "0 to 1", "1.1")),
        ("1,2,10,20,30,80,1,1,nan", ("visible fraction", "0 to 1", "nan")),
    ],
)
def test_a_malformed_truth_line_is_refused_by_path_line_and_value(tmp_path, line, named):
    path = tmp_path / "gt.txt"
    path.write_text(f"{GOOD_TRUTH}{line}\n2,1,10,20,30,80,1,1,1\n")
    with refused(f"{path}:2: ", *named):
        read_truth(path)


@pytest.mark.parametrize(
    "line", ["1,2,10,20,30,80,1", "1,2,10,20,30,80,nan,-1,-1,-1", "1,1,10,20,30,80,1,-1,-1,-1", "frame,id"]
)
def test_a_malformed_tracks_line_is_refused_by_path_and_line(tmp_path, line):
    path = tmp_path / "tracks.txt"
    path.write_text(f"{GOOD_TRACKS}{line}\n")
    with refused(f"{path}:2: "):
        read_tracks(path)


@pytest.mark.parametrize("read", [read_truth, read_tracks])
def test_a_missing_file_a_folder_and_bytes_that_are_not_text_are_refused(tmp_path, read):
    (tmp_path / "image.png").write_bytes(b"\x89PNG\xff\xfe")
    for name in ("none.txt", ".", "image.png"):
        with refused(tmp_path / name):
            read(tmp_path / name)


def test_a_file_that_cannot_be_written_is_refused(tmp_path):
    path = tmp_path / "no such folder" / "tracks.txt"
    with refused(path):
        write_tracks(path, tracks_of([]))


def test_arrays_are_copied_sorted_and_read_only():
    box = np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]])
    tracks = TrackBoxes(frame=[2, 1], id=[0, 0], box=box, confidence=[0.5, 1.0])
    box[:] = 0.0
    assert tracks.frame.tolist() == [1, 2]
    assert tracks.box[0].tolist() == [5.0, 6.0, 7.0, 8.0]
    with pytest.raises(ValueError, match="read-only"):
        tracks.box[0, 0] = 3.0


def test_impossible_arrays_are_refused_by_column_or_row():
    one = {"frame": [1], "id": [1], "box": [[0, 0, 1, 1]], "counted": [True], "visible": [1.0]}
    with refused("'box'", "(1, 4)", "(4,)"):
        TrueBoxes(**one | {"box": [0, 0, 1, 1]})
    with refused("truth: row 0", "visible fraction", "0 to 1", "got 2"):
        TrueBoxes(**one | {"visible": [2.0]})


def test_other_classes_of_motchallenge_do_not_count_or_are_left_out(tmp_path):
    path = tmp_path / "gt.txt"
    kinds = {1: 1, 2: 1, 3: 8, 4: 3, 5: 7}  # id: class; 3 is a car
    path.write_text(
        "".join(f"1,{number},{100 * number},20,30,80,1,{kind},1\n" for number, kind in kinds.items())
    )
    truth = read_truth(path)
    assert truth.id.tolist() == [1, 2, 3, 5]
    assert truth.counted.tolist() == [True, True, False, False]
